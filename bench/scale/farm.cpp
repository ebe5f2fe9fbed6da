// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/farm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

#include "bench/scale/farm_client.hpp"
#include "bench/scale/page_viewers.hpp"
#include "bench/scale/simulated_workers.hpp"
#include "bench/scale/tile_watchers.hpp"

namespace tessera::bench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kDonePolls = 200ms;

// Returns the id of the first, which is passed on as soon as it is submitted.
core::Result<std::string> submit_jobs(
    v1::RenderService::Stub& users, const Load& load,
    const std::function<core::Status(const std::string&)>& submitted_first) {
  if (auto uploaded = upload_scene(users); !uploaded) return core::fail(uploaded.error());
  v1::SubmitJobRequest request = request_of_scene(load.width_px, load.height_px, load.spp);
  for (const std::string& layer : core::layer_names(load.layers))
    request.mutable_overrides()->mutable_layers()->add_names(layer);
  std::string first;
  for (int job = 0; job < load.jobs; ++job) {
    request.set_name(fmt::format("simulated-{}", job));
    const auto submitted = submit_job(users, request);
    if (!submitted) return core::fail(submitted.error());
    if (job > 0) continue;
    first = submitted->id();
    if (auto followed = submitted_first(first); !followed) return core::fail(followed.error());
  }
  while (any_is_validated(users)) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return first;
}

bool all_done(const std::vector<v1::Job>& jobs) {
  return !jobs.empty() && std::all_of(jobs.begin(), jobs.end(),
                                      [](const v1::Job& job) { return job.state() == v1::JOB_STATE_DONE; });
}

// The film memory of tiles with samples. Ranges are leased in passes over the whole image, the first two of
// which have one sample each. Small sums take 4 bytes each, and the sums of odd samples take none before
// there are any. (In later passes it is up to 48 bytes for each pixel.)
std::uint64_t touched_film_bytes(const std::vector<v1::Job>& jobs) {
  std::uint64_t bytes = 0;
  for (const v1::Job& job : jobs) {
    const std::uint64_t pixels = std::uint64_t{job.settings().width_px()} * job.settings().height_px();
    const std::uint64_t done = job.samples_done();
    bytes += 12 * std::min(pixels, done) + 12 * std::min(pixels, done - std::min(pixels, done));
  }
  return bytes;
}

void wait_until_done(v1::RenderService::Stub& users, double at_most_seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(at_most_seconds);
  while (Clock::now() < end && !all_done(list_jobs(users))) std::this_thread::sleep_for(kDonePolls);
}

}  // namespace

core::Result<Figures> measure(const Load& load, const std::filesystem::path& coordinator_program) {
  const TemporaryFolder folder;
  const auto coordinator =
      MeasuredCoordinator::start({coordinator_program, folder.path(), load.coordinator_core,
                                  load.coordinator_options, load.page_viewers > 0});
  if (!coordinator) return core::fail(coordinator.error());
  const auto channel = own_connection(coordinator->address());
  if (!channel) return core::fail(channel.error());
  v1::RenderService::Stub users(*channel);

  Figures figures;
  figures.before_jobs = coordinator->usage();
  PageViewers viewers;
  Tally tally([&viewers](const core::PixelRect& rect) { viewers.counted(rect); });
  SimulatedWorkers workers(tally, load.layers);
  const bool is_shown = load.page_viewers > 0;
  if (is_shown)
    if (auto started = workers.start(load.workers, load.speed, coordinator->address()); !started)
      return core::fail(started.error());
  Clock::time_point submitted_at{};
  const auto submitted = submit_jobs(users, load, [&](const std::string& id) {
    submitted_at = Clock::now();
    return is_shown ? viewers.start(load.page_viewers, coordinator->page_address(), id) : core::Status();
  });
  if (!submitted) return core::fail(submitted.error());
  TileWatchers watchers;
  const core::Status watched =
      watchers.start(load.watchers, *submitted, [&] { return own_connection(coordinator->address()); });
  if (!watched) return core::fail(watched.error());
  if (load.until_done) tally.start();
  figures.before = coordinator->usage();
  figures.own_cpu_seconds = -own_cpu_seconds();
  auto start = Clock::now();
  if (!is_shown)
    if (auto started = workers.start(load.workers, load.speed, coordinator->address()); !started)
      return core::fail(started.error());
  if (load.until_done) {
    wait_until_done(users, load.measured_seconds);
  } else {
    std::this_thread::sleep_for(std::chrono::duration<double>(load.warm_up_seconds));
    tally.start();
    figures.before = coordinator->usage();
    figures.own_cpu_seconds = -own_cpu_seconds();
    figures.watched_tiles = watchers.tiles() + viewers.tiles();
    figures.watched_bytes = watchers.bytes() + viewers.bytes();
    viewers.take_delays();
    start = Clock::now();
    std::this_thread::sleep_for(std::chrono::duration<double>(load.measured_seconds));
  }
  figures.counts = tally.stop();
  figures.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  figures.after = coordinator->usage();
  figures.watched_tiles = watchers.tiles() + viewers.tiles() - figures.watched_tiles;
  figures.watched_bytes = watchers.bytes() + viewers.bytes() - figures.watched_bytes;
  figures.shown_seconds = viewers.take_delays();
  if (const auto first = viewers.first_tile())
    figures.first_pixel_seconds = std::chrono::duration<double>(*first - submitted_at).count();
  if (!load.until_done && watchers.ended() + viewers.ended() > 0)
    return core::fail(core::ErrorCode::kInternal, "the coordinator has ended a watch of tiles");
  figures.own_cpu_seconds += own_cpu_seconds();
  const std::vector<v1::Job> jobs = list_jobs(users);
  figures.all_done = all_done(jobs);
  figures.film_bytes = touched_film_bytes(jobs);
  return figures;
}

}  // namespace tessera::bench
