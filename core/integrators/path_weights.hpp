// SPDX-License-Identifier: Apache-2.0
// Weights of path samples: multiple importance sampling, Russian roulette and the clamp of indirect light.
// Pure functions.
#pragma once

#include <cmath>

#include "core/lights/mis_compensation.hpp"
#include "core/math/lane_array.hpp"
#include "core/scene/settings.hpp"

namespace tessera::core::integrators {

// The first vertex with Russian roulette, and the scales of the survival probability there and further on.
inline constexpr int kFirstRouletteDepth = 1;
inline constexpr float kFirstSurvivalScale = 1.6f, kSurvivalScale = 1.2f;

// Whether light samples of the integrator leave to BSDF samples what these find as well.
inline lights::MisCompensation mis_compensation(Integrator integrator) {
  return integrator == Integrator::kMis ? lights::MisCompensation::kOn : lights::MisCompensation::kOff;
}

// The balance or the power heuristic for two densities with one sample of each (Veach and Guibas 1995).
// Squares of the densities may overflow, but not their ratio.
template <typename T>
T mis_weight(Heuristic heuristic, T pdf, T other_pdf) {
  if (heuristic == Heuristic::kBalance) return pdf / (pdf + other_pdf);
  const T ratio = other_pdf / pdf;
  return 1 / (1 + ratio * ratio);
}

// Russian roulette (Arvo and Kirk 1990). The throughput is corrected for the compression of radiance by
// refraction, which leaving the glass undoes, and for the guiding densities, because guided directions
// carry more light (Vorba and Křivánek 2016). The survival probability is proportional to its square root:
// continuing dim paths costs time, terminating them adds variance. The first roulette is the mildest, since
// all light from more than two bounces passes it. Survival has no bound below 1: otherwise a path that
// loses less than that at each vertex would gain weight indefinitely.
template <typename T>
MaskOf<T> survives_roulette(RgbOf<T>& throughput, T eta_scale, T guiding_pdf_ratio, int depth, T u) {
  const T contribution = max_component(throughput) * eta_scale * guiding_pdf_ratio;
  const MaskOf<T> survives = contribution > 0;
  if (depth < kFirstRouletteDepth) return survives;
  using std::sqrt;
  const float scale = depth == kFirstRouletteDepth ? kFirstSurvivalScale : kSurvivalScale;
  const T survival = smaller(T(1.0f), scale * sqrt(contribution));
  throughput *= 1 / survival;
  return survives & (u < survival);
}

// Scales the radiance so that no channel exceeds `limit`.
inline Rgb clamped(Rgb radiance, float limit) {
  const float most = max_component(radiance);
  return most > limit ? radiance * (limit / most) : radiance;
}

}  // namespace tessera::core::integrators
