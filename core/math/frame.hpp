// SPDX-License-Identifier: Apache-2.0
// Orthonormal bases around a direction.
#pragma once

#include <cmath>

#include "core/math/vec3.hpp"

namespace tessera::core {

// Local coordinates in which `normal` is +z.
template <typename T>
struct FrameOf {
  Vec3Of<T> tangent, bitangent, normal;

  // `n` must have unit length (Duff et al. 2017).
  static FrameOf around(Vec3Of<T> n) {
    using std::copysign;
    const T sign = copysign(T(1.0f), n.z);
    const T a = -1.0f / (sign + n.z);
    const T b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }

  // The same frame turned about its normal so that its tangent lies below `direction`, which need not be a
  // unit vector; as it is where that has no direction in its plane.
  FrameOf turned_to(Vec3Of<T> direction) const {
    using std::sqrt;
    const Vec3Of<T> local = to_local(direction);
    const T length2 = local.x * local.x + local.y * local.y, scale = 1 / sqrt(length2);
    const MaskOf<T> known = length2 > 0;
    const T x = select(known, local.x * scale, T(1.0f)), y = select(known, local.y * scale, T(0.0f));
    return {tangent * x + bitangent * y, bitangent * x - tangent * y, normal};
  }

  Vec3Of<T> to_local(Vec3Of<T> v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }
  Vec3Of<T> to_world(Vec3Of<T> v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
};
using Frame = FrameOf<float>;

}  // namespace tessera::core
