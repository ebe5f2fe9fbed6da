// Bounds on rounding errors, and the floats next to a float.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

namespace tessera::core {

// (1 + e1) ... (1 + en) with |ei| at most the unit roundoff of T differs from 1 by at most gamma<T>(n)
// (Higham 2002, lemma 3.1).
template <typename T>
constexpr T gamma(int n) {
  constexpr T unit_roundoff = std::numeric_limits<T>::epsilon() / 2;
  return static_cast<T>(n) * unit_roundoff / (1 - static_cast<T>(n) * unit_roundoff);
}

// The least float above x; x itself if it is infinity or NaN.
inline float next_float_up(float x) {
  if (!(x < std::numeric_limits<float>::infinity())) return x;
  if (x == 0) return std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return std::bit_cast<float>(x > 0 ? bits + 1 : bits - 1);
}

// The greatest float below x; x itself if it is minus infinity or NaN.
inline float next_float_down(float x) {
  return -next_float_up(-x);
}

// The greatest float that is not above x.
inline float rounded_down(double x) {
  const auto nearest = static_cast<float>(x);
  return static_cast<double>(nearest) > x ? next_float_down(nearest) : nearest;
}

}  // namespace tessera::core
