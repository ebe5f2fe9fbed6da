// SPDX-License-Identifier: Apache-2.0
#include "worker/render_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/printable.hpp"
#include "core/common/log.hpp"

namespace tessera::worker {
namespace {

// The current scene, the next one, and one that returns.
constexpr std::size_t kScenesKept = 3;

constexpr std::size_t kMaxReasonBytes = 4096;
constexpr const char* kNoMemory = "not enough memory to build and render the scene";

bool files_are_here(const SceneFiles& files) {
  return std::all_of(files.blob_paths.begin(), files.blob_paths.end(), [](const auto& blob) {
    std::error_code unknown;
    return std::filesystem::exists(blob.second, unknown);
  });
}

}  // namespace

RenderLoop::RenderLoop(int threads, LeaseTracker& lease_tracker, Metrics& metrics, LoadScene load,
                       std::optional<core::SceneStore> store, Render render)
    : threads_(threads),
      render_(std::move(render)),
      lease_tracker_(lease_tracker),
      metrics_(metrics),
      scenes_(kScenesKept, threads, metrics, std::move(load), std::move(store)) {}

void RenderLoop::run(const std::stop_token& stop) {
  const auto size_piece = [this](const std::string& job_id) { return pace_.target_samples(job_id); };
  while (const auto piece = lease_tracker_.take(stop, size_piece)) {
    metrics_.step_began = Metrics::Clock::now();
    render(*piece, stop);
    metrics_.step_began = Metrics::Clock::time_point::max();
  }
}

// Cached scenes of other jobs may take the memory: a second attempt runs without them.
void RenderLoop::render(const Piece& piece, const std::stop_token& stop) {
  for (const bool first : {true, false}) {
    std::string why = kNoMemory;
    try {
      const core::Status done = try_to_render(piece, stop);
      if (done) return;
      why = done.error().message;
    } catch (const std::bad_alloc&) {
    } catch (const std::system_error& error) {
      why = fmt::format("cannot build and render the scene: {}", error.what());
    }
    const bool others = scenes_.has_others(piece.job->files);
    scenes_.clear();
    if (first && others) continue;
    return decline(piece, why);
  }
}

// The reason may contain names of the scene, which a loader that was taken over may have made up.
void RenderLoop::decline(const Piece& piece, const std::string& why) {
  const std::string shown = core::printable_lines(std::string_view(why).substr(0, kMaxReasonBytes));
  common::log(spdlog::level::err, fmt::format("job {}: {}", piece.job->id, shown), {.job = piece.job->id});
  lease_tracker_.cannot_render(piece, shown);
}

void RenderLoop::give_back(const Piece& piece, const core::Error& why) {
  const bool stopped = why.code == core::ErrorCode::kCancelled;
  if (!stopped && files_are_here(piece.job->files)) return decline(piece, why.message);
  // Files that were removed from the cache are no fault of the scene: they are fetched again.
  if (!stopped)
    common::log(spdlog::level::err, fmt::format("job {}: {}", piece.job->id, why.message),
                {.job = piece.job->id});
  lease_tracker_.cannot_render(piece, "");
}

core::Status RenderLoop::try_to_render(const Piece& piece, const std::stop_token& stop) {
  const std::int32_t frame = piece.job->frame_of(piece.item.image);
  const auto plans = scenes_.get(piece.job->files, frame, stop);
  if (!plans && plans.error().code == core::ErrorCode::kResourceExhausted) return core::fail(plans.error());
  if (!plans) {
    give_back(piece, plans.error());
    return {};
  }
  lease_tracker_.begins(piece);
  const auto start = Metrics::Clock::now();
  metrics_.step_began = start;
  const core::integrators::RenderPlan plan = (*plans)->get(piece.job->settings, threads_);
  core::FilmTile tile = render_(plan, piece.item.rect, piece.item.range, threads_);
  const auto took = Metrics::Clock::now() - start;
  const std::uint64_t samples = piece.item.rect.pixel_count() * piece.item.range.count();
  metrics_.samples_rendered += samples;
  Metrics::add(metrics_.render_ns, took);
  pace_.measured(piece.job->id, samples, took);
  lease_tracker_.rendered(piece, std::move(tile), took);
  return {};
}

}  // namespace tessera::worker
