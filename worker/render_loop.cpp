// SPDX-License-Identifier: Apache-2.0
#include "worker/render_loop.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <new>
#include <system_error>
#include <utility>

namespace tessera::worker {
namespace {

// The current scene, the next one, and one that returns.
constexpr std::size_t kScenesKept = 3;

constexpr const char* kNoMemory = "not enough memory to build and render the scene";

bool files_are_here(const SceneFiles& files) {
  return std::all_of(files.blob_paths.begin(), files.blob_paths.end(), [](const auto& blob) {
    std::error_code unknown;
    return std::filesystem::exists(blob.second, unknown);
  });
}

}  // namespace

RenderLoop::RenderLoop(int threads, LeaseTracker& lease_tracker, std::optional<core::SceneStore> store,
                       Render render)
    : threads_(threads),
      render_(std::move(render)),
      lease_tracker_(lease_tracker),
      scenes_(kScenesKept, threads, std::move(store)) {}

void RenderLoop::run(const std::stop_token& stop) {
  const auto size_piece = [this](const std::string& job_id) { return pace_.target_samples(job_id); };
  while (const auto piece = lease_tracker_.take(stop, size_piece)) render(*piece);
}

// Cached scenes of other jobs may take the memory: a second attempt runs without them.
void RenderLoop::render(const Piece& piece) {
  for (const bool first : {true, false}) {
    try {
      return try_to_render(piece);
    } catch (const std::bad_alloc&) {
      const bool others = scenes_.has_others(piece.job->files);
      scenes_.clear();
      if (first && others) continue;
      decline(piece, kNoMemory);
      return;
    }
  }
}

void RenderLoop::decline(const Piece& piece, const std::string& why) {
  spdlog::error("job {}: {}", piece.job->id, why);
  lease_tracker_.cannot_render(piece, why);
}

void RenderLoop::try_to_render(const Piece& piece) {
  const auto scene = scenes_.get(piece.job->files);
  if (!scene && scene.error().code == core::ErrorCode::kResourceExhausted) throw std::bad_alloc();
  if (!scene && !files_are_here(piece.job->files)) {
    // Files that were removed from the cache are no fault of the scene: they are fetched again.
    spdlog::error("job {}: {}", piece.job->id, scene.error().message);
    return lease_tracker_.cannot_render(piece, "");
  }
  if (!scene) return decline(piece, scene.error().message);
  lease_tracker_.begins(piece);
  const auto start = std::chrono::steady_clock::now();
  core::FilmTile tile = render_(**scene, piece.job->settings, piece.item.rect, piece.item.range, threads_);
  const auto took = std::chrono::steady_clock::now() - start;
  const std::uint64_t samples = piece.item.rect.pixel_count() * piece.item.range.count();
  samples_ += samples;
  pace_.measured(piece.job->id, samples, took);
  lease_tracker_.rendered(piece, std::move(tile), took);
}

}  // namespace tessera::worker
