// SPDX-License-Identifier: Apache-2.0
#include "client/farm/tev_watch.hpp"

#include <chrono>
#include <cstddef>
#include <stop_token>
#include <utility>

#include "client/farm/job_text.hpp"
#include "client/farm/tile_image.hpp"
#include "client/tev_connection.hpp"
#include "client/tev_packets.hpp"
#include "core/view/tile_pixels.hpp"
#include "proto/convert.hpp"

namespace tessera::client {
namespace {

constexpr std::chrono::milliseconds kLookForTevEvery{50};
// A coordinator that sends a larger one is not believed: that is 32 MiB.
constexpr std::size_t kMaxTileValues = std::size_t{1} << 23;

// One connection to tev and the stream that feeds it.
class TileFeed {
 public:
  TileFeed(Farm& farm, const std::string& job_id, const std::string& address, const std::stop_token& stop)
      : farm_(farm), job_id_(job_id), address_(address), stop_(stop) {}

  // Sends tiles until the job is over. Errors of tev and of the coordinator end it.
  core::Status run() {
    auto tev = TevConnection::open(address_);
    if (!tev) return core::fail(tev.error());
    const auto format = best_format();
    if (!format) return core::fail(format.error());
    grpc::ClientContext context;
    const std::jthread canceller = cancel_when_stopped(context);
    v1::WatchTilesRequest request;
    request.set_job_id(job_id_);
    request.set_format(*format);
    const auto stream = farm_.stub().WatchTiles(&context, request);
    v1::WatchTilesResponse response;
    core::Status sent;
    while (sent && stream->Read(&response)) sent = show(response, *tev);
    if (!sent) context.TryCancel();
    const grpc::Status status = stream->Finish();
    if (!sent) return sent;
    if (!status.ok()) return core::fail(farm_.explain(status, context));
    return {};
  }

 private:
  // With all layers, if the coordinator knows any.
  core::Result<v1::TileFormat> best_format() {
    const auto has_layers = has_feature(farm_, "layers");
    if (!has_layers) return core::fail(has_layers.error());
    return *has_layers ? v1::TILE_FORMAT_ALL32F : v1::TILE_FORMAT_RGB32F;
  }

  std::jthread cancel_when_stopped(grpc::ClientContext& context) const {
    return std::jthread([&context, stop = stop_](const std::stop_token& done) {
      while (!done.stop_requested() && !stop.stop_requested() && !interrupted())
        std::this_thread::sleep_for(kLookForTevEvery);
      if (!done.stop_requested()) context.TryCancel();
    });
  }

  core::Status show(const v1::WatchTilesResponse& response, TevConnection& tev) {
    if (response.has_job()) window_ = proto::window_of(response.job().settings());
    if (response.tiles().empty()) return {};
    if (image_.name.empty())
      if (core::Status created = create(response, tev); !created) return created;
    for (const v1::TileImage& tile : response.tiles())
      if (core::Status sent = send(tile, tev); !sent) return sent;
    return {};
  }

  core::Status create(const v1::WatchTilesResponse& response, TevConnection& tev) {
    image_ = {"job " + short_id(job_id_), window_.width(), window_.height(), {"R", "G", "B"}};
    if (!response.channels().empty())
      image_.channels = {response.channels().begin(), response.channels().end()};
    return tev.send(tev_create_image(image_));
  }

  core::Status send(const v1::TileImage& tile, TevConnection& tev) const {
    const auto rect = rect_in_window(tile, window_);
    if (!rect) return core::fail(rect.error());
    const std::size_t count = rect->pixel_count() * image_.channels.size();
    if (count > kMaxTileValues)
      return core::fail(core::ErrorCode::kDataLoss, "a tile of the coordinator is too large");
    const auto values = view::decode_channels(tile.pixels_zlib(), count);
    if (!values) return core::fail(values.error());
    return tev.send(tev_update_image(image_, *rect, *values));
  }

  Farm& farm_;
  const std::string& job_id_;
  const std::string& address_;
  const std::stop_token stop_;
  core::PixelRect window_;
  TevImage image_;  // without a name before there are tiles
};

}  // namespace

TevWatch::TevWatch(Farm& farm, std::string job_id, std::string address, Notices& notices)
    : thread_([this, &farm, job_id = std::move(job_id), address = std::move(address),
               &notices](const std::stop_token& stop) {
        // The stream begins anew with each connection: another tev has none of the tiles.
        const auto gives_up = [&] { return stop.stop_requested() || is_last_ || interrupted(); };
        for (;;) {
          const core::Status shown = TileFeed(farm, job_id, address, stop).run();
          if (shown || stop.stop_requested() || interrupted()) return;
          notices.add(shown.error().message);
          const auto until =
              std::chrono::steady_clock::now() + std::chrono::duration<double>(kTevRetrySeconds);
          while (!gives_up() && std::chrono::steady_clock::now() < until)
            std::this_thread::sleep_for(kLookForTevEvery);
          if (gives_up()) return;
        }
      }) {}

void TevWatch::finish(bool is_over) {
  if (!thread_.joinable()) return;
  is_last_ = true;
  if (!is_over) thread_.request_stop();
  thread_.join();
}

}  // namespace tessera::client
