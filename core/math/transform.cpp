// SPDX-License-Identifier: Apache-2.0
#include "core/math/transform.hpp"

#include "core/math/elementary.hpp"

namespace tessera::core {

Vec3 Transform::normal(Vec3 n) const {
  return cross(y_axis, z_axis) * n.x + cross(z_axis, x_axis) * n.y + cross(x_axis, y_axis) * n.z;
}

Transform compose(const Transform& outer, const Transform& inner) {
  return {outer.direction(inner.x_axis), outer.direction(inner.y_axis), outer.direction(inner.z_axis),
          outer.point(inner.origin)};
}

Transform translation(Vec3 offset) {
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, offset};
}

Transform scaling(Vec3 factors) {
  return {{factors.x, 0, 0}, {0, factors.y, 0}, {0, 0, factors.z}, {0, 0, 0}};
}

Transform rotation(Vec3 axis, float degrees) {
  const Vec3 k = normalize(axis);
  const float angle = degrees * (kPi / 180), s = sin(angle), c = cos(angle);
  const auto rotate = [&](Vec3 v) { return v * c + cross(k, v) * s + k * (dot(k, v) * (1 - c)); };
  return {rotate({1, 0, 0}), rotate({0, 1, 0}), rotate({0, 0, 1}), {0, 0, 0}};
}

}  // namespace tessera::core
