// SPDX-License-Identifier: Apache-2.0
// Evaluates polynomials with few dependent steps (Estrin 1960): terms are combined in pairs, then pairs of
// pairs, for instruction-level parallelism. The order of operations, and so every bit of the result, is the
// same everywhere.
#pragma once

#include <array>
#include <cstddef>

namespace tessera::core {

// coefficients[0] + coefficients[1] x + coefficients[2] x^2 + ... Real may be a vector type.
template <typename Real, typename Coefficient, std::size_t kCount>
constexpr Real polynomial(Real x, const std::array<Coefficient, kCount>& coefficients) {
  if constexpr (kCount == 1) {
    return Real(coefficients[0]);
  } else {
    std::array<Real, (kCount + 1) / 2> pairs{};
    for (std::size_t i = 0; i < kCount / 2; ++i) pairs[i] = coefficients[2 * i] + coefficients[2 * i + 1] * x;
    if constexpr (kCount % 2 == 1) pairs.back() = Real(coefficients.back());
    return polynomial(x * x, pairs);
  }
}

}  // namespace tessera::core
