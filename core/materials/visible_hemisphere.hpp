// SPDX-License-Identifier: Apache-2.0
// The normals of a hemisphere that are visible from a direction, from which the visible normals of GGX
// follow by stretching (Heitz 2018). T is float for one point, or FloatN for one in each lane.
#pragma once

#include <cmath>

#include "core/math/vec3.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {

// Samples a normal of the unit hemisphere around +z in proportion to its area as seen from `w`, a unit
// vector with w.z > 0.
template <typename T>
Vec3Of<T> sample_visible_hemisphere(Vec3Of<T> w, Vec2Of<T> u) {
  using std::sqrt;
  const T across2 = w.x * w.x + w.y * w.y;
  const Vec3Of<T> t1 = select(across2 > 0, Vec3Of<T>{-w.y, w.x, 0} / sqrt(across2), Vec3Of<T>{1, 0, 0});
  const Vec3Of<T> t2 = cross(w, t1);
  // The hemisphere's projection onto the plane perpendicular to `w`: a half disk and a half ellipse.
  const Vec2Of<T> p = sampling::sample_disk(u);
  const T share = 0.5f * (1 + w.z);
  const T p2 = (1 - share) * sqrt(larger(T(0.0f), 1 - p.x * p.x)) + share * p.y;
  return t1 * p.x + t2 * p2 + w * sqrt(larger(T(0.0f), 1 - p.x * p.x - p2 * p2));
}

}  // namespace tessera::core
