#include "core/math/elementary.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tessera::core {
namespace {

// x minus the nearest multiple of pi/2, in [-pi/4, pi/4], and that multiple's number modulo 4. The constant
// is split so that its first part times any multiple met here is exact (Cody and Waite 1980).
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
  return r + r * s * (-1.0 / 6 + s * (1.0 / 120 + s * (-1.0 / 5040 + s * (1.0 / 362880 - s / 39916800))));
}
double cos_near_zero(double r) {
  const double s = r * r;
  return 1 + s * (-0.5 + s * (1.0 / 24 +
                              s * (-1.0 / 720 + s * (1.0 / 40320 + s * (-1.0 / 3628800 + s / 479001600)))));
}

// Taylor series on [0, tan(pi/8)].
double atan_near_zero(double x) {
  const double s = x * x;
  double sum = 0;
  for (int n = 25; n >= 1; n -= 2) sum = 1.0 / n - s * sum;
  return x * sum;
}

// On [0, 1].
double atan_unit(double x) {
  constexpr double kTanEighthTurn = 0.41421356237309504880;
  constexpr double kQuarterPi = 0.78539816339744830962;
  return x <= kTanEighthTurn ? atan_near_zero(x) : kQuarterPi - atan_near_zero((1 - x) / (1 + x));
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

float atan2(float y, float x) {
  constexpr double kPiDouble = 3.14159265358979323846;
  const double ax = std::fabs(x), ay = std::fabs(y);
  if (ax == 0 && ay == 0) return 0;
  double angle = ay <= ax ? atan_unit(ay / ax) : kPiDouble / 2 - atan_unit(ax / ay);
  if (x < 0) angle = kPiDouble - angle;
  return static_cast<float>(y < 0 ? -angle : angle);
}

double exp(double x) {
  if (x < -708) return 0;
  if (x > 709) return std::numeric_limits<double>::infinity();
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const double k = std::nearbyint(x * 1.44269504088896340736);
  const double r = (x - k * kLn2High) - k * kLn2Low;
  double sum = 1;
  for (int n = 14; n >= 1; --n) sum = 1 + r / n * sum;  // Taylor series on |r| <= ln(2) / 2
  const auto power_of_two = static_cast<std::uint64_t>(static_cast<std::int64_t>(k) + 1023) << 52;
  return sum * std::bit_cast<double>(power_of_two);
}

double log(double x) {
  constexpr double kLn2 = 0.69314718055994530942, kSqrtHalf = 0.70710678118654752440;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // exact on every machine
  if (mantissa < kSqrtHalf) {
    mantissa *= 2;
    --exponent;
  }
  const double s = (mantissa - 1) / (mantissa + 1), s2 = s * s;
  double sum = 0;
  for (int n = 23; n >= 1; n -= 2) sum = 1.0 / n + s2 * sum;  // log(m) = 2 artanh(s)
  return exponent * kLn2 + 2 * s * sum;
}

double pow(double base, double exponent) {
  if (exponent == 0) return 1;
  if (base == 0) return exponent > 0 ? 0 : std::numeric_limits<double>::infinity();
  return exp(exponent * log(base));
}

}  // namespace tessera::core
