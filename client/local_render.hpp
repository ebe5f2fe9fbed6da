// SPDX-License-Identifier: Apache-2.0
// Renders an image in this process, or the window of it that the settings ask for, call by call, with
// progress and a way out.
#pragma once

#include <functional>
#include <vector>

#include "client/progress.hpp"
#include "client/render_observer.hpp"
#include "client/shared_film.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

struct LocalRender {
  const core::Scene& scene;
  const core::RenderSettings& settings;
  int threads = 1;
  std::vector<RenderObserver*> observers{};
};

// Takes the samples that `film` lacks: each tile of its grid has its samples from 0 to some number. Blocks
// until the film is complete, or `should_stop` says so, which is asked a few times a second. Returns whether
// it is complete.
bool render_locally(const LocalRender& render, SharedFilm& film, ProgressLine& progress,
                    const std::function<bool()>& should_stop);

}  // namespace tessera::client
