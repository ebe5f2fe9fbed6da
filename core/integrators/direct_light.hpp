// SPDX-License-Identifier: Apache-2.0
// Direct light at a path vertex, shared by the integrators.
#pragma once

#include "core/film/film.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/vertex.hpp"
#include "core/lights/light_sample.hpp"

namespace tessera::core::integrators {

// A number in [0, 1) with 48 bits from two of 24, so that weak lights among strong ones can be sampled.
template <typename T>
WideOf<T> combine_uniforms(T coarse, T fine) {
  return widened(coarse) + widened(fine) * 0x1p-24;
}

// The light reflected along wo from the light's radiance: BSDF * cosine * radiance, not yet divided by the
// density. `enclosure` is that of the vertex.
inline Rgb reflected_light(const Scene& scene, const PathVertex& vertex, const lights::LightSample& light,
                           const Enclosure& enclosure, RenderCounters& counters) {
  const Rgb scattered = vertex.evaluate(light.wi).value;
  if (is_black(scattered)) return {};
  const Rgb share = transmittance(scene, vertex.ray_toward(light), enclosure, counters.shadow_rays);
  return is_black(share) ? Rgb{} : scattered * light.radiance * share;
}

}  // namespace tessera::core::integrators
