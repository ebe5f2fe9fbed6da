// SPDX-License-Identifier: Apache-2.0
#include "core/math/quaternion.hpp"

#include <cmath>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

Quaternion weighted_sum(Quaternion a, float of_a, Quaternion b, float of_b) {
  return {a.w * of_a + b.w * of_b, a.x * of_a + b.x * of_b, a.y * of_a + b.y * of_b, a.z * of_a + b.z * of_b};
}

float norm(Quaternion q) {
  return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
}

Quaternion unit(Quaternion q) {
  const float scale = 1 / norm(q);
  return {q.w * scale, q.x * scale, q.y * scale, q.z * scale};
}

}  // namespace

Quaternion rotation_quaternion(Vec3 axis, float degrees) {
  const float half_angle = degrees * (kPi / 360);
  const Vec3 v = normalize(axis) * sin(half_angle);
  return unit({cos(half_angle), v.x, v.y, v.z});
}

// The angle comes from the lengths of sum and difference, which is accurate also where it is small.
Quaternion slerp(Quaternion a, Quaternion b, float t) {
  if (t == 0 || a == b) return a;
  const float cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (cosine < 0) b = weighted_sum(b, -1, b, 0);  // the same rotation
  const float angle = 2 * atan2(norm(weighted_sum(a, 1, b, -1)), norm(weighted_sum(a, 1, b, 1)));
  constexpr float kSmallAngle = 1e-3f;  // below it, the sines are proportional to their angles
  if (angle < kSmallAngle) return unit(weighted_sum(a, 1 - t, b, t));
  return unit(weighted_sum(a, sin((1 - t) * angle), b, sin(t * angle)));
}

Transform rotation(Quaternion q) {
  const auto [w, x, y, z] = q;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
          {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
          {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)},
          {0, 0, 0}};
}

}  // namespace tessera::core
