// Orthonormal bases around a direction.
#pragma once

#include <cmath>

#include "core/math/vec3.hpp"

namespace tessera::core {

// Local coordinates in which `normal` is +z.
struct Frame {
  Vec3 tangent, bitangent, normal;

  // `n` must be of unit length (Duff et al. 2017).
  static Frame around(Vec3 n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }

  Vec3 to_local(Vec3 v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }
  Vec3 to_world(Vec3 v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
};

}  // namespace tessera::core
