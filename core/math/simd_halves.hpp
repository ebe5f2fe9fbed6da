// SPDX-License-Identifier: Apache-2.0
// A vector of floats as two halves of four, for computations with points and boxes: three lanes of each half
// are coordinates.
#pragma once

#include <array>

#include "core/math/simd_integer.hpp"

namespace tessera::core {

// The same four numbers in both halves.
inline FloatN in_both_halves(float x, float y, float z, float w) {
  return _mm256_setr_ps(x, y, z, w, x, y, z, w);
}
// The lower halves of `a` and `b`, and the upper ones; that of `a` becomes the lower half.
inline FloatN lower_halves(FloatN a, FloatN b) {
  return _mm256_permute2f128_ps(a.v, b.v, 0x20);
}
inline FloatN upper_halves(FloatN a, FloatN b) {
  return _mm256_permute2f128_ps(a.v, b.v, 0x31);
}
inline FloatN with_halves_swapped(FloatN a) {
  return _mm256_permute2f128_ps(a.v, a.v, 1);
}
// Sets lane 3 to 0.
inline FloatN without_lane_3(FloatN a) {
  return _mm256_blend_ps(a.v, _mm256_setzero_ps(), 1 << 3);
}

// Transposes each half: lane i of result d is lane d of row i. There is no row 3, so lane 3 is unspecified.
inline std::array<FloatN, 3> transposed_halves(FloatN row_0, FloatN row_1, FloatN row_2) {
  const __m256 x_and_y = _mm256_unpacklo_ps(row_0.v, row_1.v), z = _mm256_unpackhi_ps(row_0.v, row_1.v);
  return {_mm256_shuffle_ps(x_and_y, row_2.v, _MM_SHUFFLE(0, 0, 1, 0)),
          _mm256_shuffle_ps(x_and_y, row_2.v, _MM_SHUFFLE(1, 1, 3, 2)),
          _mm256_shuffle_ps(z, row_2.v, _MM_SHUFFLE(2, 2, 1, 0))};
}

// Loads four numbers from each pointer.
inline U32xN load_halves(const std::uint32_t* lower, const std::uint32_t* upper) {
  return _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(upper),
                             reinterpret_cast<const __m128i*>(lower));
}

}  // namespace tessera::core
