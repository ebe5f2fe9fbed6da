// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/integrators/render.hpp"
#include "core/scene/scene.hpp"
#include "tests/fuzz/expect.hpp"

namespace tessera::fuzz {

// Rendering cannot fail, whatever the scene. Nearly all of the time would go into photons.
inline void render_corner(const core::Scene& scene, const core::RenderSettings& settings) {
  constexpr core::PixelRect kCorner{0, 0, 1, 1};
  constexpr core::SampleRange kSamples{0, 2};
  const auto plan = core::integrators::prepare(scene, settings, 1, core::integrators::kPhotonPathsAtOnce);
  const core::FilmTile tile = core::integrators::render(plan, kCorner, kSamples, 1);
  expect(tile.counters.samples == kSamples.count(), "every sample is counted");
}

}  // namespace tessera::fuzz
