// Eight doubles: the lanes of a Float8 where floats do not suffice.
#pragma once

#include "core/math/simd.hpp"

namespace tessera::core {

struct Double8 {
  Double4 low, high;

  Double8() = default;
  Double8(Double4 first_four, Double4 last_four) : low(first_four), high(last_four) {}
  Double8(double every) : low(every), high(every) {}
  static Double8 load(const double* aligned) { return {Double4::load(aligned), Double4::load(aligned + 4)}; }
  void store(double* aligned) const { low.store(aligned), high.store(aligned + 4); }
};

template <>
struct Lanes<Float8> {
  using Mask = Mask8;
  using Wide = Double8;
  static constexpr int kCount = 8;
};

inline Double8 widened(Float8 a) {
  return {_mm256_cvtps_pd(_mm256_castps256_ps128(a.v)), _mm256_cvtps_pd(_mm256_extractf128_ps(a.v, 1))};
}
inline Float8 to_float(Double8 a) {
  return _mm256_set_m128(_mm256_cvtpd_ps(a.high.v), _mm256_cvtpd_ps(a.low.v));
}

inline Double8 operator+(Double8 a, Double8 b) {
  return {a.low + b.low, a.high + b.high};
}
inline Double8 operator-(Double8 a, Double8 b) {
  return {a.low - b.low, a.high - b.high};
}
inline Double8 operator-(Double8 a) {
  return {-a.low, -a.high};
}
inline Double8 operator*(Double8 a, Double8 b) {
  return {a.low * b.low, a.high * b.high};
}
inline Double8 operator/(Double8 a, Double8 b) {
  return {a.low / b.low, a.high / b.high};
}
inline Double8 max(Double8 a, Double8 b) {
  return {max(a.low, b.low), max(a.high, b.high)};
}
inline Double8 min(Double8 a, Double8 b) {
  return {min(a.low, b.low), min(a.high, b.high)};
}
inline Double8 fabs(Double8 a) {
  return {abs(a.low), abs(a.high)};
}
inline Double8 sqrt(Double8 a) {
  return {sqrt(a.low), sqrt(a.high)};
}
inline Double8 copysign(Double8 magnitude, Double8 sign) {
  return {copysign(magnitude.low, sign.low), copysign(magnitude.high, sign.high)};
}
inline Double8 nearbyint(Double8 a) {
  return {nearbyint(a.low), nearbyint(a.high)};
}

// The upper halves of eight 64-bit lanes, which hold all a mask needs.
inline Mask8 narrowed(__m256d low, __m256d high) {
  const __m256 mixed =
      _mm256_shuffle_ps(_mm256_castpd_ps(low), _mm256_castpd_ps(high), _MM_SHUFFLE(3, 1, 3, 1));
  return _mm256_castpd_ps(_mm256_permute4x64_pd(_mm256_castps_pd(mixed), _MM_SHUFFLE(3, 1, 2, 0)));
}
inline Mask8 operator<(Double8 a, Double8 b) {
  return narrowed(_mm256_cmp_pd(a.low.v, b.low.v, _CMP_LT_OQ), _mm256_cmp_pd(a.high.v, b.high.v, _CMP_LT_OQ));
}
inline Mask8 operator>(Double8 a, Double8 b) {
  return b < a;
}
inline Mask8 operator>=(Double8 a, Double8 b) {
  return narrowed(_mm256_cmp_pd(a.low.v, b.low.v, _CMP_GE_OQ), _mm256_cmp_pd(a.high.v, b.high.v, _CMP_GE_OQ));
}
inline Double8 select(Mask8 mask, Double8 a, Double8 b) {
  const __m256i lanes = _mm256_castps_si256(mask.v);
  const __m256i low = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(lanes));
  const __m256i high = _mm256_cvtepi32_epi64(_mm256_extracti128_si256(lanes, 1));
  return {_mm256_blendv_pd(b.low.v, a.low.v, _mm256_castsi256_pd(low)),
          _mm256_blendv_pd(b.high.v, a.high.v, _mm256_castsi256_pd(high))};
}

}  // namespace tessera::core
