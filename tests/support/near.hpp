// SPDX-License-Identifier: Apache-2.0
// Vectors that are to be the same up to rounding.
#pragma once

#include <gtest/gtest.h>

#include "core/math/vec3.hpp"

namespace tessera::core {

inline void expect_near(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_LE(length(a - b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " is not " << b.x << ' ' << b.y << ' ' << b.z;
}

}  // namespace tessera::core
