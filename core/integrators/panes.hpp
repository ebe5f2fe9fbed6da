// SPDX-License-Identifier: Apache-2.0
// Panes: between parallel surfaces of smooth glass, light is refracted twice, or reflected in between, and
// goes on in its direction. What arrives so from the environment is straight light, which light samples find
// like direct light: the directions that paths sample are not likely to meet a small sun. Stateless;
// thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "core/film/film.hpp"
#include "core/geometry/ray.hpp"
#include "core/guiding/light_guide.hpp"
#include "core/integrators/pane_passage.hpp"
#include "core/math/rgb.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

// Whether the material may be that of a pane, where its surface is smooth: glass of one index for all
// wavelengths.
bool is_pane_glass(const Material& material);

// Whether two unit directions are the same within 1e-4 radians: but for rounding, and
// panes that are not quite parallel.
inline bool is_straight(Vec3 a, Vec3 b) {
  constexpr float kMaxSine = 1e-4f;
  return length_squared(cross(a, b)) < kMaxSine * kMaxSine && dot(a, b) > 0;
}

// The share of the light from the far end of a ray without end that arrives straight, by all ways that
// PanePassage allows, of at most `max_surfaces` surfaces, where the ray itself hits something first at `hit`.
// Counts the rays that it traces.
Rgb straight_transmittance(const Scene& scene, const Ray& ray, const Hit& hit, int max_surfaces,
                           RenderCounters& counters);

// Whether enough of the light of the photons is straight for light samples to look for it. If so, removes
// these photons.
bool remove_straight(const Scene& scene, std::vector<guiding::Photon>& photons);

}  // namespace tessera::core::integrators
