// SPDX-License-Identifier: Apache-2.0
// Bounds on rounding errors, and neighbouring floats.
#pragma once

#include <limits>

#include "core/math/simd_integer.hpp"

namespace tessera::core {

// (1 + e1) ... (1 + en) with |ei| at most the unit roundoff of T differs from 1 by at most gamma<T>(n)
// (Higham 2002, lemma 3.1).
template <typename T>
constexpr T gamma(int n) {
  constexpr T unit_roundoff = std::numeric_limits<T>::epsilon() / 2;
  return static_cast<T>(n) * unit_roundoff / (1 - static_cast<T>(n) * unit_roundoff);
}

// The smallest float above x; x itself if it is infinity or NaN.
template <typename T>
T next_float_up(T x) {
  const auto bits = as_bits(x);
  const T next = select(x == 0, T(std::numeric_limits<float>::denorm_min()),
                        as_float(select(x > 0, bits + 1u, bits - 1u)));
  return select(x < std::numeric_limits<float>::infinity(), next, x);
}

// The greatest float below x; x itself if it is minus infinity or NaN.
template <typename T>
T next_float_down(T x) {
  return -next_float_up(-x);
}

// The float next to x in the direction of `offset`; x itself if `offset` is 0.
template <typename T>
T rounded_away(T x, T offset) {
  const MaskOf<T> down = offset < 0;
  const T stepped = next_float_up(select(down, -x, x));
  return select((offset > 0) | down, select(down, -stepped, stepped), x);
}

// The greatest float that is not above x, a double.
template <typename D>
auto rounded_down(D x) {
  const auto nearest = to_float(x);
  return select(widened(nearest) > x, next_float_down(nearest), nearest);
}

}  // namespace tessera::core
