// SPDX-License-Identifier: Apache-2.0
// Unit quaternions, for interpolating rotations. w is the real part.
#pragma once

#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

struct Quaternion {
  float w = 1, x = 0, y = 0, z = 0;

  bool operator==(const Quaternion&) const = default;
};

// The rotation counter-clockwise seen from the tip of `axis`, which must not be zero. Whole turns are lost.
Quaternion rotation_quaternion(Vec3 axis, float degrees);

// Turns from `a` (t = 0) to `b` (t = 1) at constant speed along the shorter arc (Shoemake 1985). `a` and `b`
// have unit length, and so has the result.
Quaternion slerp(Quaternion a, Quaternion b, float t);

// The map that rotates as a quaternion of unit length (Shoemake 1985).
Transform rotation(Quaternion q);

}  // namespace tessera::core
