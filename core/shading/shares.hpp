// SPDX-License-Identifier: Apache-2.0
// Parameters that are shares of something. T is float for one point, or FloatN for one in each lane.
#pragma once

#include <type_traits>

#include "core/math/rgb.hpp"

namespace tessera::core::shading {

// Clamped to [0, 1]; 0 for NaN.
template <typename T>
T unit(T value) {
  return select(value > 0, smaller(value, T(1.0f)), T(0.0f));
}

template <typename T>
RgbOf<T> unit(RgbOf<T> color) {
  return {unit(color.r), unit(color.g), unit(color.b)};
}

// From `a` at a share of 0 to `b` at 1.
template <typename T>
T mix(T a, T b, std::type_identity_t<T> share) {
  return a + (b - a) * share;
}

template <typename T>
RgbOf<T> mix(RgbOf<T> a, RgbOf<T> b, std::type_identity_t<T> share) {
  return a + (b - a) * share;
}

}  // namespace tessera::core::shading
