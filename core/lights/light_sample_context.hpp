// SPDX-License-Identifier: Apache-2.0
// The reference point for light sampling.
#pragma once

#include "core/math/simd.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

struct LightSampleContext {
  Vec3 position{};
  Vec3 normal{};  // unit, of the side that is lit; zero if light counts from all sides
};

// Eight contexts.
struct LightSampleContexts {
  Vec3Of<Float8> position, normal;
};

}  // namespace tessera::core
