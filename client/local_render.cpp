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

// Observers from begin() to end(), also when rendering fails.
class Observation {
 public:
  Observation(const LocalRender& render, const core::Film& film) : observers_(render.observers) {
    for (RenderObserver* observer : observers_) observer->begin(film, render.settings);
  }
  ~Observation() {
    for (RenderObserver* observer : observers_) observer->end();
  }
  Observation(const Observation&) = delete;
  Observation& operator=(const Observation&) = delete;

 private:
  const std::vector<RenderObserver*>& observers_;
};

struct Clock {
  double seconds = steady_seconds(), core_seconds = client::core_seconds();
};

}  // namespace

bool render_locally(const LocalRender& render, SharedFilm& film, ProgressLine& progress,
                    const std::function<bool()>& should_stop) {
  const core::RenderSettings& settings = render.settings;
  const core::TileGrid& grid = film.grid();
  ProgressState state;
  state.samples_done = film.totals().counters.samples;
  state.samples_total = std::uint64_t{grid.window().pixel_count()} * settings.spp;
  const Observation observation(render, film.film());
  WorkCutter cutter(grid, settings.spp, samples_of_tiles(film.film()));
  std::uint64_t target = 1;
  Clock now;
  progress.update(state, now.seconds);
  const core::integrators::RenderPlan plan =
      core::integrators::prepare(render.scene, settings, render.threads);
  while (const std::optional<WorkPiece> piece = cutter.next(target)) {
    if (should_stop()) return false;
    const core::FilmTile tile = core::integrators::render(plan, piece->rect, piece->range, render.threads);
    const Clock before = now;
    now = Clock();
    const RenderTotals work{tile.counters, now.seconds - before.seconds,
                            now.core_seconds - before.core_seconds};
    film.add(tile, work, render.observers);
    state.samples_done += piece->samples();
    target = next_target(piece->samples(), work.seconds);
    progress.update(state, now.seconds);
  }
  progress.finish(state, now.seconds);
  return true;
}

}  // namespace tessera::client
