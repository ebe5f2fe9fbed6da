// SPDX-License-Identifier: Apache-2.0
// Axis-aligned boxes.
#pragma once

#include <limits>

#include "core/math/vec3.hpp"

namespace tessera::core {

// The points with lower <= p <= upper in every coordinate; empty when default-constructed.
struct Aabb {
  Vec3 lower{kInfinity, kInfinity, kInfinity};
  Vec3 upper{-kInfinity, -kInfinity, -kInfinity};

  void include(Vec3 p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  void include(const Aabb& box) {
    lower = min(lower, box.lower);
    upper = max(upper, box.upper);
  }
  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }

  // Half of the surface area, 0 if empty; in double, so that no coordinate allowed in a scene overflows it.
  double half_area() const {
    if (empty()) return 0;
    const double dx = extent(0), dy = extent(1), dz = extent(2);
    return dx * dy + dy * dz + dz * dx;
  }
  double extent(int axis) const {
    return static_cast<double>(upper[axis]) - static_cast<double>(lower[axis]);
  }

  bool operator==(const Aabb&) const = default;

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
};

}  // namespace tessera::core
