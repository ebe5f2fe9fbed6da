// SPDX-License-Identifier: Apache-2.0
#include "client/local_render.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "client/console.hpp"
#include "client/render_stats.hpp"
#include "client/work_cutter.hpp"
#include "core/integrators/render.hpp"

namespace tessera::client {
namespace {

constexpr double kSecondsPerCall = 0.25;

// How much the next call should do, judging by the last one, which took `samples` samples in `seconds`.
std::uint64_t next_target(std::uint64_t samples, double seconds) {
  constexpr double kLargestGrowth = 8;
  const double growth = std::min(kSecondsPerCall / std::max(seconds, 1e-6), kLargestGrowth);
  return static_cast<std::uint64_t>(static_cast<double>(samples) * growth) + 1;
}

}  // namespace

LocalRender render_locally(const core::Scene& scene, const core::RenderSettings& settings, int threads,
                           ProgressLine& progress, const std::function<bool()>& should_stop) {
  const core::TileGrid grid(settings.window(), core::kTilePx);
  LocalRender result(grid);
  ProgressState state;
  state.samples_total = std::uint64_t{grid.window().pixel_count()} * settings.spp;
  const double start = steady_seconds(), start_core = core_seconds();
  double now = start;
  WorkCutter cutter(grid, settings.spp);
  std::uint64_t target = 1;
  progress.update(state, now);
  while (!should_stop()) {
    const std::optional<WorkPiece> piece = cutter.next(target);
    result.complete = !piece;
    if (!piece) break;
    const core::FilmTile tile = core::render(scene, settings, piece->rect, piece->range, threads);
    result.film.add(tile);
    result.counters.add(tile.counters);
    state.samples_done += piece->samples();
    const double before = now;
    now = steady_seconds();
    target = next_target(piece->samples(), now - before);
    progress.update(state, now);
  }
  result.seconds = now - start;
  result.core_seconds = core_seconds() - start_core;
  if (result.complete) progress.finish(state, now);
  return result;
}

}  // namespace tessera::client
