// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/filter_warp.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"

namespace tessera::core::sampling {
namespace {

// The normal distribution's probability below -3.
constexpr double kTailBeyondThree = 1.3498980316300946e-3;

// The value below which a standard normal variable falls with probability p (Wichura 1988, algorithm AS 241,
// PPND7: seven digits), for p from 1e-10 to 1 - 1e-10.
double normal_quantile(double p) {
  const double q = p - 0.5;
  if (std::fabs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * (((59.109374720 * r + 159.29113202) * r + 50.434271938) * r + 3.3871327179) /
           (((67.187563600 * r + 78.757757664) * r + 17.895169469) * r + 1);
  }
  const double r = std::sqrt(-log(std::min(p, 1 - p))) - 1.6;
  const double z = (((0.17023821103 * r + 1.3067284816) * r + 2.7568153900) * r + 1.4234372777) /
                   ((0.12021132975 * r + 0.73700164250) * r + 1);
  return q < 0 ? -z : z;
}

}  // namespace

float sample_box(float u, float radius) {
  return (2 * u - 1) * radius;
}

float sample_tent(float u, float radius) {
  return u < 0.5f ? (std::sqrt(2 * u) - 1) * radius : (1 - std::sqrt(2 - 2 * u)) * radius;
}

float sample_truncated_normal(float u, float radius) {
  const double p = kTailBeyondThree + static_cast<double>(u) * (1 - 2 * kTailBeyondThree);
  const auto sigmas = static_cast<float>(normal_quantile(p));
  return std::clamp(sigmas / 3, -1.0f, 1.0f) * radius;
}

}  // namespace tessera::core::sampling
