// Whole numbers beside the lanes of T, for formulae that look things up in tables: WordOf<float> is one
// number of 32 bits, WordOf<Float8> are eight.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/math/simd_integer.hpp"

namespace tessera::core {

template <typename T>
using WordOf = std::conditional_t<std::is_same_v<T, float>, std::uint32_t, U32x8>;

// table[index], of each lane.
inline float look_up(const float* table, std::uint32_t index) {
  return table[index];
}
inline std::uint32_t look_up(const std::uint32_t* table, std::uint32_t index) {
  return table[index];
}
inline Float8 look_up(const float* table, U32x8 index) {
  return Float8::gather(table, index.v);
}
inline U32x8 look_up(const std::uint32_t* table, U32x8 index) {
  return U32x8::gather(table, index);
}

}  // namespace tessera::core
