// What integrators share: light that reaches a vertex of a path straight from a light.
#pragma once

#include "core/film/film.hpp"
#include "core/integrators/vertex.hpp"
#include "core/lights/light_sample.hpp"

namespace tessera::core {

// One number in [0, 1) of 48 bits from two of 24, so that lights of little power among great ones can be
// chosen.
inline double two_digits(float coarse, float fine) {
  return static_cast<double>(coarse) + static_cast<double>(fine) * 0x1p-24;
}

// What leaves the vertex towards where its ray came from, of the radiance that the light sends: BSDF * cosine
// * radiance, not yet divided by the density. Black where something is in between.
inline Rgb reflected_light(const Scene& scene, const PathVertex& vertex, const LightSample& light,
                           RenderCounters& counters) {
  const Rgb scattered = vertex.evaluate(light.wi).value;
  if (is_black(scattered)) return {};
  ++counters.shadow_rays;
  return scene.bvh().any_hit(scene.primitives(), vertex.ray_toward(light)) ? Rgb{}
                                                                           : scattered * light.radiance;
}

}  // namespace tessera::core
