// SPDX-License-Identifier: Apache-2.0
// Radiance as an unsigned 64-bit fixed-point number, which makes sums of samples exact. Integer addition of
// non-negative numbers is associative and commutative even when it saturates, so the image does not depend
// on how samples were partitioned, ordered or retried.
#pragma once

#include <cstdint>
#include <limits>

namespace tessera::core {

// The unit is 2^-26 (1.5e-8); a million samples of a pixel may average 262,144 before the sum saturates.
inline constexpr int kFilmFractionBits = 26;
inline constexpr double kFilmUnit = 1.0 / (std::uint64_t{1} << kFilmFractionBits);
inline constexpr std::uint64_t kFilmSaturated = std::numeric_limits<std::uint64_t>::max();

// Stochastic rounding with `dither` in [0, 1) as the random number. The expectation is exact, so light
// below the unit is not lost. `radiance` must be finite and non-negative; values that do not fit in 64 bits
// become kFilmSaturated.
inline std::uint64_t to_fixed_point(double radiance, double dither) {
  const double scaled = radiance / kFilmUnit;
  if (scaled >= 18446744073709549568.0) return kFilmSaturated;  // the largest double below 2^64
  const auto whole = static_cast<std::uint64_t>(scaled);
  const bool up = scaled - static_cast<double>(whole) > dither;
  return whole + (up ? 1 : 0);
}

inline std::uint64_t add_saturating(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t sum = a + b;
  return sum < a ? kFilmSaturated : sum;
}

}  // namespace tessera::core
