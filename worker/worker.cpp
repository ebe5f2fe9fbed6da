// SPDX-License-Identifier: Apache-2.0
#include "worker/worker.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <functional>
#include <optional>
#include <thread>

#include "core/common/log.hpp"
#include "core/scene/cache/scene_store.hpp"
#include "worker/cache_meter.hpp"
#include "worker/deliver_loop.hpp"
#include "worker/fetch_loop.hpp"
#include "worker/lease_tracker.hpp"
#include "worker/segment_source.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {
namespace {

// Uses the folder of the blobs, and counts toward the same limit.
std::optional<core::SceneStore> open_scene_store(const BlobCache& cache) {
  auto store = core::SceneStore::open(
      cache.folder(), cache.max_bytes(), [](const std::string& message) { spdlog::warn("{}", message); },
      BlobCache::is_file_name);
  if (store) return std::move(*store);
  spdlog::warn("built scenes are not kept: {}", store.error().message);
  return std::nullopt;
}

void log_traffic(const BlobCache::Traffic& traffic) {
  spdlog::info("has fetched {} bytes of scene files, {} of them from other workers, and sent {} to others",
               traffic.received_bytes.load(), traffic.peer_received_bytes.load(),
               traffic.peer_sent_bytes.load());
}

long seconds(Duration time) {
  return static_cast<long>(std::chrono::round<std::chrono::seconds>(time).count());
}

std::string describe(const UnwantedPiece& unwanted) {
  const proto::WorkItem& item = unwanted.piece.item;
  const Duration for_nobody = std::chrono::steady_clock::now() - unwanted.unwanted_since;
  return fmt::format(
      "job {}: samples [{}, {}) of the tile with the pixels [{}, {}) x [{}, {}) did not finish in {} s, and "
      "nobody wanted them for the last {} s: this worker gives them up",
      unwanted.piece.job->id, item.range.begin, item.range.end, item.rect.x0, item.rect.x1, item.rect.y0,
      item.rect.y1, seconds(unwanted.wanted_for + for_nobody), seconds(for_nobody));
}

}  // namespace

Worker::Worker(Identity identity, const BlobCache& cache, v1::WorkerService::StubInterface& coordinator,
               Options options)
    : identity_(std::move(identity)),
      cache_(cache),
      coordinator_(coordinator),
      options_(std::move(options)) {}

void Worker::run(const std::stop_token& stop) {
  LeaseTracker lease_tracker;
  CacheMeter meter(cache_);
  SyncLoop sync(identity_, coordinator_, lease_tracker, metrics_, options_.explain, SyncLoop::kRefusalBackoff,
                [&meter](v1::SynchronizeRequest& request) { *request.mutable_cache() = meter.read(); });
  SegmentSource source(identity_.worker_key, cache_, coordinator_, options_.peer_server);
  FetchLoop fetch(cache_, source, lease_tracker, std::hash<std::string>{}(identity_.worker_id));
  RenderLoop render(static_cast<int>(identity_.threads), lease_tracker, metrics_, options_.load_scene,
                    open_scene_store(cache_), options_.render);
  DeliverLoop deliver(identity_, coordinator_, lease_tracker, metrics_);

  std::stop_source working;  // requested by a stop, also of the coordinator
  const std::stop_callback end_work(stop, [&] { working.request_stop(); });
  const std::stop_callback drop_all_wanted(working.get_token(), [&] { lease_tracker.drop_all_wanted(); });

  bool told_to_stop = false;  // by the coordinator
  std::thread sync_thread([&] {
    told_to_stop = sync.run(working.get_token());
    metrics_.next_call_by = Metrics::Clock::time_point::max();
    if (told_to_stop) spdlog::info("an administrator has asked this worker to stop");
    working.request_stop();
  });
  std::thread fetch_thread([&] { fetch.run(working.get_token()); });
  std::stop_source delivering;
  std::stop_source all_delivered;
  std::thread deliver_thread([&] {
    deliver.run(delivering.get_token());
    all_delivered.request_stop();
  });

  std::stop_source rendering;
  std::thread render_thread([&] {
    render.run(working.get_token());
    rendering.request_stop();
  });

  const auto endless = lease_tracker.abandon_endless(rendering.get_token(), options_.hang_timeout);
  if (endless) common::log(spdlog::level::warn, describe(*endless), {.job = endless->piece.job->id});
  working.request_stop();
  lease_tracker.drain();
  sync_thread.join();
  fetch_thread.join();
  if (wait_for(all_delivered.get_token(), options_.drain_deadline)) delivering.request_stop();
  deliver_thread.join();
  sync.deregister();
  spdlog::info("has rendered {} samples", metrics_.samples_rendered.load());
  log_traffic(cache_.traffic());
  if (endless) options_.self_restart(*endless, told_to_stop);
  render_thread.join();
}

}  // namespace tessera::worker
