// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/tile_watchers.hpp"

#include <grpcpp/client_context.h>

#include <future>
#include <utility>

#include "tessera/v1/render_service.grpc.pb.h"

namespace tessera::bench {

class TileWatchers::Watch final : public grpc::ClientReadReactor<v1::WatchTilesResponse> {
 public:
  Watch(TileWatchers& all, const std::shared_ptr<grpc::Channel>& channel, const std::string& job_id)
      : all_(all), stub_(v1::RenderService::NewStub(channel)) {
    request_.set_job_id(job_id);
    request_.set_format(v1::TILE_FORMAT_RGB16F);
    stub_->async()->WatchTiles(&context_, &request_, this);
    StartRead(&response_);
    StartCall();
  }
  ~Watch() override {
    context_.TryCancel();
    done_.get_future().wait();
  }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) return;
    all_.tiles_ += static_cast<std::uint64_t>(response_.tiles_size());
    all_.bytes_ += response_.ByteSizeLong();
    StartRead(&response_);
  }
  void OnDone(const grpc::Status&) override {
    ++all_.ended_;
    done_.set_value();
  }

  TileWatchers& all_;
  const std::unique_ptr<v1::RenderService::Stub> stub_;
  grpc::ClientContext context_;
  v1::WatchTilesRequest request_;
  v1::WatchTilesResponse response_;
  std::promise<void> done_;
};

TileWatchers::TileWatchers() = default;
TileWatchers::~TileWatchers() = default;

core::Status TileWatchers::start(int count, const std::string& job_id, const Connect& connect) {
  for (int i = 0; i < count; ++i) {
    auto channel = connect();
    if (!channel) return core::fail(channel.error());
    watches_.push_back(std::make_unique<Watch>(*this, *channel, job_id));
  }
  return {};
}

}  // namespace tessera::bench
