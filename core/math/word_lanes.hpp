// SPDX-License-Identifier: Apache-2.0
// Unsigned integers in the lanes of T, for table lookups: WordOf<float> is one 32-bit number,
// WordOf<FloatN> a vector of them.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/math/simd_integer.hpp"

namespace tessera::core {

template <typename T>
using WordOf = std::conditional_t<std::is_same_v<T, float>, std::uint32_t, U32xN>;

// The integer part of x; negative ones wrap modulo 2^32. Of NaN and of numbers beyond 32 bits, 2^31.
inline std::uint32_t to_word(float x) {
  return static_cast<std::uint32_t>(_mm_cvttss_si32(_mm_set_ss(x)));
}
inline U32xN to_word(FloatN x) {
  return _mm256_cvttps_epi32(x.v);
}

inline std::uint32_t smaller_word(std::uint32_t a, std::uint32_t b) {
  return b < a ? b : a;
}
inline U32xN smaller_word(U32xN a, U32xN b) {
  return min(a, b);
}

// table[index], of each lane.
inline float look_up(const float* table, std::uint32_t index) {
  return table[index];
}
inline FloatN look_up(const float* table, U32xN index) {
  return FloatN::gather(table, index.v);
}

}  // namespace tessera::core
