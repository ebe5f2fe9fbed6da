// SPDX-License-Identifier: Apache-2.0
// Renders a picture in this process, or the window of it that the settings ask for, call by call, with
// progress and a way out.
#pragma once

#include <functional>

#include "client/progress.hpp"
#include "core/film/film.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

struct LocalRender {
  explicit LocalRender(core::TileGrid grid) : film(grid) {}

  core::Film film;
  core::RenderCounters counters;
  double seconds = 0;       // by the clock on the wall
  double core_seconds = 0;  // of all cores together
  bool complete = false;    // or stopped before the end
};

// Blocks until every sample is taken or `should_stop` says so, which is asked a few times a second.
LocalRender render_locally(const core::Scene& scene, const core::RenderSettings& settings, int threads,
                           ProgressLine& progress, const std::function<bool()>& should_stop);

}  // namespace tessera::client
