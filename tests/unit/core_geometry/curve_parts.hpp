// SPDX-License-Identifier: Apache-2.0
// Parts of curves for tests, and vectors for them.
#pragma once

#include <cmath>
#include <cstddef>

#include "core/geometry/curves.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core::test {

inline CurvePart straight(Vec3d start, Vec3d end, double start_radius, double end_radius,
                          CurveShape shape = CurveShape::kRound) {
  CurvePart part;
  part.shape = shape;
  for (std::size_t i = 0; i < 4; ++i) {
    const double share = static_cast<double>(i) / 3;
    part.points[i] = (1 - share) * start + share * end;
    part.radii[i] = (1 - share) * start_radius + share * end_radius;
  }
  return part;
}

inline Vec3d place(const CurvePart& part, double u) {
  const double v = 1 - u;
  return v * v * v * part.points[0] + 3 * u * v * v * part.points[1] + 3 * u * u * v * part.points[2] +
         u * u * u * part.points[3];
}

inline Vec3d unit(Vec3d v) {
  return (1 / length(v)) * v;
}

inline Vec3d wide(Random& random, float half_size) {
  return Vec3d(random.in_box(half_size));
}

// A part that bends by about a right angle, of any thickness up to half of its radius of curvature.
inline CurvePart bent(Random& random, CurveShape shape) {
  CurvePart part;
  part.shape = shape;
  part.points[0] = wide(random, 1);
  const Vec3d along = Vec3d(random.direction());
  for (std::size_t i = 1; i < 4; ++i) part.points[i] = part.points[i - 1] + along + 0.3 * wide(random, 1);
  const double thickness = std::ldexp(0.3, -static_cast<int>(random.below(12)));
  for (double& radius : part.radii) radius = thickness * static_cast<double>(random.uniform(0.8f, 1.2f));
  return part;
}

}  // namespace tessera::core::test
