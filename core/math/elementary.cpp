// SPDX-License-Identifier: Apache-2.0
#include "core/math/elementary.hpp"

#include <array>
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

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Real is double or DoubleN.
template <typename Real>
Real exponential(Real x) {
  using std::nearbyint;
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const Real k = nearbyint(x * 1.44269504088896340736);
  const Real r = (x - k * kLn2High) - k * kLn2Low;
  // The error on |r| <= ln(2) / 2 is at most 3e-16 (Remez 1934).
  constexpr std::array kBeyondLinear{0.5000000000000016,     0.16666666666610455,    0.04166666666648109,
                                     0.008333333371365952,   0.001388888895756761,   0.00019841184573301873,
                                     2.4801478261937464e-05, 2.7635264240555523e-06, 2.763556219125641e-07};
  const Real value = (1 + (r + r * r * polynomial(r, kBeyondLinear))) * power_of_two(k);
  return select(x < -708, Real(0.0), select(x > 709, Real(kInfinity), value));
}

template <typename Real>
Real logarithm(Real x) {
  constexpr double kLn2 = 0.69314718055994530942;
  const auto subnormal = x < std::numeric_limits<double>::min();
  const Real normal = select(subnormal, x * 0x1p54, x);
  const Real mantissa = mantissa_near_one(normal);
  const Real s = (mantissa - 1) / (mantissa + 1), s2 = s * s;
  // log(m) = 2 artanh(s) = 2 s + s^3 p(s^2), with an error of p of at most 4e-11 (Remez 1934).
  constexpr std::array kBeyondLinear{0.6666666666658758, 0.40000000052132884, 0.2857141714890788,
                                     0.22223370503096,   0.18123676476624645, 0.16819453485623553};
  const Real exponent = exponent_near_one(normal) - select(subnormal, Real(54.0), Real(0.0));
  return exponent * kLn2 + (2 * s + s * s2 * polynomial(s2, kBeyondLinear));
}

template <typename Real>
Real power(Real base, Real exponent) {
  const Real of_zero = select(exponent > 0, Real(0.0), Real(kInfinity));
  const Real value = select(base == 0, of_zero, exponential(exponent * logarithm(base)));
  return select(exponent == 0, Real(1.0), value);
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
  return exponential(x);
}
double log(double x) {
  return logarithm(x);
}
double pow(double base, double exponent) {
  return power(base, exponent);
}
DoubleN exp(DoubleN x) {
  return exponential(x);
}
DoubleN log(DoubleN x) {
  return logarithm(x);
}
DoubleN pow(DoubleN base, DoubleN exponent) {
  return power(base, exponent);
}

}  // namespace tessera::core
