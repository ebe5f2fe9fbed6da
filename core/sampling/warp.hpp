// SPDX-License-Identifier: Apache-2.0
// Warps of the unit square, each with its density. `u` has coordinates in [0, 1).
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core::sampling {

// Uniform on the unit disk; continuous (Shirley and Chiu 1997).
template <typename T = float>
Vec2Of<T> sample_disk(Vec2Of<T> u) {
  using std::fabs;
  const T a = 2 * u.x - 1, b = 2 * u.y - 1;
  const MaskOf<T> beside = fabs(a) > fabs(b);  // rather than above or below
  const T radius = select(beside, a, b), across = select(beside, b, a);
  const auto [s, c] = sin_cos_near_zero(0.5f * across / select(radius == 0, T(1.0f), radius));
  return {radius * select(beside, c, s), radius * select(beside, s, c)};
}

// The same map in polar coordinates: the distance from the centre in [0, 1], and the angle from +x towards +y
// in turns, in [0, 1].
struct PolarPoint {
  float radius, turns;
};
inline PolarPoint sample_disk_polar(Vec2 u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool beside = std::fabs(a) > std::fabs(b);  // rather than above or below
  float eighths = beside ? b / a : 2 - a / b;
  if ((beside ? a : b) < 0) eighths += 4;
  return {beside ? std::fabs(a) : std::fabs(b), (eighths < 0 ? eighths + 8 : eighths) / 8};
}

// On the hemisphere around +z, density cos(theta) / pi per solid angle (Malley's method). z is positive.
template <typename T = float>
Vec3Of<T> sample_cosine_hemisphere(Vec2Of<T> u) {
  using std::sqrt;
  const Vec2Of<T> d = sample_disk(u);
  return {d.x, d.y, sqrt(larger(T(1e-12f), 1 - d.x * d.x - d.y * d.y))};
}
template <typename T>
T pdf_cosine_hemisphere(T cos_theta) {
  return larger(T(0.0f), cos_theta) / kPi;
}

// Uniform on the unit sphere, density 1 / (4 pi) per solid angle.
template <typename T = float>
Vec3Of<T> sample_sphere(Vec2Of<T> u) {
  using std::sqrt;
  const T z = 1 - 2 * u.x, r = sqrt(larger(T(0.0f), 1 - z * z));
  const auto [s, c] = sin_cos_turns(u.y);
  return {r * c, r * s, z};
}

// Uniform on the hemisphere around +z, density 1 / (2 pi) per solid angle. z is positive.
template <typename T = float>
Vec3Of<T> sample_hemisphere(Vec2Of<T> u) {
  using std::sqrt;
  const T z = 1 - u.x, r = sqrt(larger(T(0.0f), 1 - z * z));
  const auto [s, c] = sin_cos_turns(u.y);
  return {r * c, r * s, z};
}

// Barycentric coordinates of a triangle's second and third corner, uniform over its area (Heitz 2019).
inline Vec2 sample_triangle(Vec2 u) {
  if (u.y > u.x) {
    const float b1 = u.x * 0.5f;
    return {b1, u.y - b1};
  }
  const float b2 = u.y * 0.5f;
  return {u.x - b2, b2};
}

}  // namespace tessera::core::sampling
