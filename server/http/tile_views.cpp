// SPDX-License-Identifier: Apache-2.0
#include "server/http/tile_views.hpp"

#include "core/view/stream_query.hpp"
#include "server/http/handlers.hpp"
#include "server/http/read_json.hpp"
#include "server/http/watch_quota.hpp"
#include "server/jobs/image_choice.hpp"

namespace tessera::http_api {

namespace {

// Beyond so many entries, those of jobs that nobody looks at are removed.
constexpr std::size_t kManySources = 256;

// A tile stream, as a call.
class TileBody final : public http::BodySource {
 public:
  TileBody(CallPtr call, base::FairShare::Held place, std::shared_ptr<watch::JobTiles> source,
           const view::StreamQuery& query)
      : call_(std::move(call)),
        place_(std::move(place)),
        stream_(std::move(source), query, call_->context.tiles.stream_settings()) {}

  void start(http::Wake wake) override { stream_.start(std::move(wake)); }
  State read(std::string& out, std::size_t max_bytes) override {
    const State state = stream_.read(out, max_bytes);
    call_->services().streams.calls.traffic.watched_sent += out.size();
    if (state == State::kEnd) call_->timer.end(grpc::Status::OK);
    return state;
  }
  std::chrono::milliseconds longest_wait() const override { return stream_.longest_wait(); }

 private:
  const CallPtr call_;
  const base::FairShare::Held place_;
  view::TileStream stream_;
};

}  // namespace

std::shared_ptr<watch::JobTiles> TileViews::shared(const Key& key) {
  const core::MutexLock lock(mutex_);
  if (sources_.size() > kManySources)
    std::erase_if(sources_, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<watch::JobTiles>& known = sources_[key];
  std::shared_ptr<watch::JobTiles> source = known.lock();
  if (!source) known = source = feed_.tiles_of(key.first, key.second);
  return source;
}

core::Result<std::shared_ptr<watch::JobTiles>> TileViews::source(const std::string& job_id,
                                                                 std::uint32_t image) {
  auto source = shared({job_id, image});
  const auto found = source->look();
  if (!found) return core::fail(found.error());
  if (auto there = jobs::check_image((*found)->shape, image); !there) return core::fail(there.error());
  return source;
}

Answer watch_tiles(const CallPtr& call) {
  const auto query = view::parse_stream_query(call->request);
  if (!query) return core::fail(query.error());
  const auto image = read_image_index(call->request);
  if (!image) return core::fail(image.error());
  auto source = call->context.tiles.source(call->id(), *image);
  if (!source) return core::fail(source.error());
  if (auto there = view::check_layer((*source)->layers(), query->layer); !there)
    return core::fail(there.error());
  auto place = take_watch(*call);
  if (!place) return core::fail(place.error());
  http::Response response{.headers = {{"Content-Type", "application/octet-stream"},
                                      {"Cache-Control", "no-store"},
                                      {"X-Accel-Buffering", "no"}}};  // nginx passes frames on at once
  response.source = std::make_unique<TileBody>(call, *std::move(place), *std::move(source), *query);
  return response;
}

}  // namespace tessera::http_api
