// SPDX-License-Identifier: Apache-2.0
// What the exact sums of a pixel's channel say of its radiance. Pure functions.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/film/fixed_point.hpp"

namespace tessera::core {

// The mean of the samples; 0 where there are none.
inline double mean_radiance(std::uint64_t sum, std::uint32_t samples) {
  return samples == 0 ? 0 : static_cast<double>(sum) * kFilmUnit / samples;
}

// Estimated standard error of the mean of all samples: half the distance of the means of the even- and the
// odd-numbered ones. 0 where either half is empty, and for a saturated sum.
inline double standard_error(std::uint64_t sum, std::uint64_t odd_sum, std::uint32_t samples,
                             std::uint32_t odd_samples) {
  if (odd_samples == 0 || odd_samples == samples || sum == kFilmSaturated) return 0;
  return std::fabs(mean_radiance(sum - odd_sum, samples - odd_samples) -
                   mean_radiance(odd_sum, odd_samples)) /
         2;
}

}  // namespace tessera::core
