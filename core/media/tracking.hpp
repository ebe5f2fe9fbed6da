// SPDX-License-Identifier: Apache-2.0
// Sampling of distances and transmittances in participating media: delta tracking (Woodcock et al. 1965) and
// ratio tracking (Novák et al. 2014), in closed form for homogeneous media. Stateless;
// thread-safe.
//
// One channel of the three, the hero, samples the distances for all. Each channel could have been it, which
// the densities by channel account for: the balance heuristic over channels and techniques in the path space
// with null collisions (Wilkie et al. 2014; Miller et al. 2019).
#pragma once

#include <optional>

#include "core/math/rgb.hpp"
#include "core/media/medium.hpp"
#include "core/sampling/sampler.hpp"

namespace tessera::core {

// The weights of a path or of a part of one. All are over the density with which the hero sampled it.
struct SpectralWeights {
  Rgb throughput = Rgb::gray(1);      // what it carries
  Rgb unidirectional = Rgb::gray(1);  // its density if the channel were the hero
  Rgb light = Rgb::gray(1);           // the same, had a light been sampled from the last vertex

  SpectralWeights& operator*=(Rgb factor) {
    throughput *= factor;
    unidirectional *= factor;
    light *= factor;
    return *this;
  }
};

// The result of sampling a collision.
struct Collision {
  std::optional<float> t;  // where the ray scatters; nothing if it passes
  Rgb emitted{};           // radiance of the medium on the way, divided by its density
};

// Samples where the ray scatters before t_max. `weights` are those of the path, up to the ray's origin before
// and up to the collision or t_max after; `light` is unspecified after a collision.
Collision sample_collision(const Medium& medium, const Ray& ray, float t_max, int hero,
                           sampling::NumberStream& numbers, SpectralWeights& weights);

// Multiplies the weights of a shadow ray by an unbiased estimate of its transmittance up to t_max, and by the
// densities. `throughput` becomes black if Russian roulette ends the estimate.
void estimate_transmittance(const Medium& medium, const Ray& ray, float t_max, int hero,
                            sampling::NumberStream& numbers, SpectralWeights& weights);

}  // namespace tessera::core
