// SPDX-License-Identifier: Apache-2.0
// The modified Bessel function of the first kind.
#pragma once

#include <array>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/polynomial.hpp"

namespace tessera::core {

// exp(-x) I0(x) for x >= 0, which is at most 1. Relative error below 5e-7 (Abramowitz and Stegun 1964, 9.8.1
// and 9.8.2). Real is double or DoubleN.
template <typename Real>
Real scaled_bessel_i0(Real x) {
  using std::sqrt;
  constexpr double kSplit = 3.75;
  const auto is_small = x < kSplit;
  Real small{}, large{};
  if (any(is_small)) {
    const Real t = x / kSplit;
    small = exp(-x) * polynomial(t * t, std::array{1.0, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.0360768,
                                                   0.0045813});
  }
  if (!all(is_small))
    large = polynomial(kSplit / x, std::array{0.39894228, 0.01328592, 0.00225319, -0.00157565, 0.00916281,
                                              -0.02057706, 0.02635537, -0.01647633, 0.00392377}) /
            sqrt(x);
  return select(is_small, small, large);
}

}  // namespace tessera::core
