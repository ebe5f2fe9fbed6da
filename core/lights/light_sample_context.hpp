// SPDX-License-Identifier: Apache-2.0
// The reference point for light sampling.
#pragma once

#include "core/math/simd.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core::lights {

template <typename T>
struct LightSampleContextOf {
  Vec3Of<T> position{};
  Vec3Of<T> normal{};  // unit, of the side that is lit; zero if light counts from all sides
};
using LightSampleContext = LightSampleContextOf<float>;
using LightSampleContexts = LightSampleContextOf<FloatN>;  // in lanes

}  // namespace tessera::core::lights
