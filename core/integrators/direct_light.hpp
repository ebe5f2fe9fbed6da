// SPDX-License-Identifier: Apache-2.0
// What integrators share: light that reaches a vertex of a path straight from a light.
#pragma once

#include "core/film/film.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/vertex.hpp"
#include "core/lights/light_sample.hpp"

namespace tessera::core {

// One number in [0, 1) of 48 bits from two of 24, so that lights of little power among great ones can be
// chosen.
inline double combine_uniforms(float coarse, float fine) {
  return static_cast<double>(coarse) + static_cast<double>(fine) * 0x1p-24;
}

// What leaves the vertex towards where its ray came from, of the radiance that the light sends: BSDF * cosine
// * radiance, not yet divided by the density. Only the share of it that passes what is in between.
inline Rgb reflected_light(const Scene& scene, const PathVertex& vertex, const LightSample& light,
                           RenderCounters& counters) {
  const Rgb scattered = vertex.evaluate(light.wi).value;
  if (is_black(scattered)) return {};
  const float share = transmittance(scene, vertex.ray_toward(light), counters.shadow_rays);
  return share > 0 ? scattered * light.radiance * share : Rgb{};
}

}  // namespace tessera::core
