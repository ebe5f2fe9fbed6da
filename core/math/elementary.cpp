// SPDX-License-Identifier: Apache-2.0
#include "core/math/elementary.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tessera::core {
namespace {

// x minus the nearest multiple of pi/2, in [-pi/4, pi/4], and the multiple's index modulo 4. The constant
// is split so that its first part times any multiple used here is exact (Cody and Waite 1980).
struct ReducedAngle {
  double r;
  int quadrant;
};

ReducedAngle reduce_angle(float x) {
  constexpr double kTwoOverPi = 0.63661977236758134308;
  constexpr double kHalfPiHigh = 1.57079632673412561417, kHalfPiLow = 6.07710050650619224932e-11;
  const double k = std::nearbyint(x * kTwoOverPi);
  return {(x - k * kHalfPiHigh) - k * kHalfPiLow, static_cast<int>(static_cast<std::int64_t>(k) & 3)};
}

// Taylor series on [-pi/4, pi/4].
double sin_near_zero(double r) {
  const double s = r * r;
  return r +
         r * s * polynomial(s, std::array{-1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800});
}
double cos_near_zero(double r) {
  const double s = r * r;
  return 1 + s * polynomial(
                     s, std::array{-0.5, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600});
}

// A power of two in the range of normal numbers.
double power_of_two(int exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

}  // namespace

float sin(float x) {
  const auto [r, quadrant] = reduce_angle(x);
  const double value = quadrant & 1 ? cos_near_zero(r) : sin_near_zero(r);
  return static_cast<float>(quadrant & 2 ? -value : value);
}

float cos(float x) {
  const auto [r, quadrant] = reduce_angle(x);
  const double value = quadrant & 1 ? sin_near_zero(r) : cos_near_zero(r);
  return static_cast<float>(quadrant == 1 || quadrant == 2 ? -value : value);
}

double exp(double x) {
  if (x < -708) return 0;
  if (x > 709) return std::numeric_limits<double>::infinity();
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const double k = std::nearbyint(x * 1.44269504088896340736);
  const double r = (x - k * kLn2High) - k * kLn2Low;
  // The error on |r| <= ln(2) / 2 is at most 3e-16 (Remez 1934).
  constexpr std::array kBeyondLinear{0.5000000000000016,     0.16666666666610455,    0.04166666666648109,
                                     0.008333333371365952,   0.001388888895756761,   0.00019841184573301873,
                                     2.4801478261937464e-05, 2.7635264240555523e-06, 2.763556219125641e-07};
  return (1 + (r + r * r * polynomial(r, kBeyondLinear))) * power_of_two(static_cast<int>(k));
}

double log(double x) {
  constexpr double kLn2 = 0.69314718055994530942, kSqrtHalf = 0.70710678118654752440;
  constexpr double kMinNormal = std::numeric_limits<double>::min();
  const bool subnormal = x < kMinNormal;
  const auto bits = std::bit_cast<std::uint64_t>(subnormal ? x * 0x1p54 : x);
  const std::uint64_t above_sqrt_half = bits - std::bit_cast<std::uint64_t>(kSqrtHalf);
  // The mantissa is in [sqrt(1/2), sqrt(2)).
  const int exponent = static_cast<int>(static_cast<std::int64_t>(above_sqrt_half) >> 52);
  const auto mantissa = std::bit_cast<double>(bits - (static_cast<std::uint64_t>(exponent) << 52));
  const double s = (mantissa - 1) / (mantissa + 1), s2 = s * s;
  // log(m) = 2 artanh(s) = 2 s + s^3 p(s^2), with an error of p of at most 4e-11 (Remez 1934).
  constexpr std::array kBeyondLinear{0.6666666666658758, 0.40000000052132884, 0.2857141714890788,
                                     0.22223370503096,   0.18123676476624645, 0.16819453485623553};
  return (exponent - (subnormal ? 54 : 0)) * kLn2 + (2 * s + s * s2 * polynomial(s2, kBeyondLinear));
}

double pow(double base, double exponent) {
  if (exponent == 0) return 1;
  if (base == 0) return exponent > 0 ? 0 : std::numeric_limits<double>::infinity();
  return exp(exponent * log(base));
}

}  // namespace tessera::core
