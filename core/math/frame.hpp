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

  Vec3Of<T> to_local(Vec3Of<T> v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }
  Vec3Of<T> to_world(Vec3Of<T> v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
};
using Frame = FrameOf<float>;

}  // namespace tessera::core
