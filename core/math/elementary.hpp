// SPDX-License-Identifier: Apache-2.0
// Elementary functions computed from IEEE additions, multiplications, divisions and square roots only. They
// return the same bits on every machine, which the C library's do not guarantee. Code that affects rendered
// images must not call std::sin and similar functions.
//
// The single-precision functions are used for every sample and are branch-free.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/math/lanes.hpp"
#include "core/math/polynomial.hpp"
#include "core/math/simd_double.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core {

inline constexpr float kPi = 3.14159265358979323846f;

template <typename T>
struct SinCosOf {
  T sin, cos;
};
using SinCos = SinCosOf<float>;

// Sine and cosine of r quarter turns, r in [-1/2, 1/2]. Absolute error below 1.5e-7, from polynomials with
// errors of at most 5e-9 (Remez 1934).
template <typename T>
SinCosOf<T> sin_cos_near_zero(T r) {
  const T s = r * r;
  return {r * polynomial(s, std::array{1.57079637f, -0.64596349f, 0.0796802267f, -0.00460217707f}),
          1 + s * polynomial(s, std::array{-1.23370051f, 0.253669262f, -0.0208603083f, 0.000904060551f})};
}

// Sine and cosine of an angle in turns, |turns| <= 1e6. Absolute error below 1.5e-7.
template <typename T>
SinCosOf<T> sin_cos_turns(T turns) {
  using std::nearbyint;
  using Word = WordOf<T>;
  const T quarter = nearbyint(4 * turns);
  const SinCosOf<T> near = sin_cos_near_zero(4 * turns - quarter);  // the difference is exact
  const Word quadrant = to_word(quarter);
  const MaskOf<T> odd = (quadrant & Word(1)) != Word(0);
  const auto negate = [](T value, Word bit1) { return as_float(as_bits(value) ^ ((bit1 & Word(2)) << 30)); };
  return {negate(select(odd, near.cos, near.sin), quadrant),
          negate(select(odd, near.sin, near.cos), quadrant + Word(1))};
}

// In [-pi, pi], with the sign of y; atan2(0, 0) is 0. Absolute error below 5e-7, from a polynomial with an
// error of at most 2e-8 (Remez 1934).
template <typename T>
T atan2(T y, T x) {
  using std::fabs, std::copysign;
  constexpr float kMin = std::numeric_limits<float>::denorm_min();
  const T ax = fabs(x), ay = fabs(y);
  const T ratio = smaller(ax, ay) / larger(larger(ax, ay), T(kMin));
  const T s = ratio * ratio;
  const T octant =
      ratio * polynomial(s, std::array{1.0f, -0.333330929f, 0.199930549f, -0.142071337f, 0.106546797f,
                                       -0.0753368139f, 0.0430394299f, -0.016283048f, 0.0029035632f});
  const T quadrant = select(ay > ax, kPi / 2 - octant, octant);
  return copysign(select(x < 0, kPi - quadrant, quadrant), y);
}

// Sine of an angle in radians, |x| <= 1e4, and likewise cosine. Absolute error below 1e-7.
float sin(float x);
float cos(float x);

// Double precision, relative error below 1e-13 (log: absolute, for results near 0).
double exp(double x);                      // 0 below -708, infinity above 709
double log(double x);                      // x > 0
double pow(double base, double exponent);  // base >= 0; pow(0, positive) is 0, pow(x, 0) is 1
// Each lane has the bits of the functions above.
DoubleN exp(DoubleN x);
DoubleN log(DoubleN x);
DoubleN pow(DoubleN base, DoubleN exponent);

}  // namespace tessera::core
