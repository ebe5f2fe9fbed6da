// SPDX-License-Identifier: Apache-2.0
// The phase function of Henyey and Greenstein (1941), which is isotropic for g = 0. Pure functions.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "core/math/vec3.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {

// The density per solid angle of scattering by an angle with this cosine to the direction of travel. g is the
// mean cosine, above -1 and below 1.
inline float henyey_greenstein(float g, float cosine) {
  const float narrowest = 1 - std::fabs(g);
  const float s = std::max(1 + g * g - 2 * g * cosine, narrowest * narrowest);
  return (1 - g * g) / (4 * kPi * s * std::sqrt(s));
}

// Samples a direction in proportion to the above; `travel` has unit length. Exact inversion (Witt 1977).
inline Vec3 sample_henyey_greenstein(float g, Vec3 travel, Vec2 u) {
  if (std::fabs(g) < 1e-6f) return sampling::sample_sphere(u);  // the inversion below would cancel
  const double a = static_cast<double>(g), x = static_cast<double>(u.x);
  const double s = (1 - a * a) / (1 + a - 2 * a * x);
  const auto cosine = static_cast<float>(std::clamp((1 + a * a - s * s) / (2 * a), -1.0, 1.0));
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  const auto [sin_around, cos_around] = sin_cos_turns(u.y);
  return normalize(Frame::around(travel).to_world({sine * cos_around, sine * sin_around, cosine}));
}

}  // namespace tessera::core
