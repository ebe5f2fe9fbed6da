// SPDX-License-Identifier: Apache-2.0
// Eight doubles: the double-precision counterpart of Float8. One register with AVX-512, else two.
#pragma once

#include "core/math/simd.hpp"

namespace tessera::core {

// The lanes of two vectors of doubles.
template <typename Half>
struct Twice {
  static constexpr std::size_t kLanes = 2 * Half::kLanes;
  Half low, high;

  Twice() = default;
  Twice(Half first_half, Half second_half) : low(first_half), high(second_half) {}
  Twice(double every) : low(every), high(every) {}
  static Twice load(const double* aligned) {
    return {Half::load(aligned), Half::load(aligned + Half::kLanes)};
  }
  void store(double* aligned) const { low.store(aligned), high.store(aligned + Half::kLanes); }

  friend Twice operator+(Twice a, Twice b) { return {a.low + b.low, a.high + b.high}; }
  friend Twice operator-(Twice a, Twice b) { return {a.low - b.low, a.high - b.high}; }
  friend Twice operator-(Twice a) { return {-a.low, -a.high}; }
  friend Twice operator*(Twice a, Twice b) { return {a.low * b.low, a.high * b.high}; }
  friend Twice operator/(Twice a, Twice b) { return {a.low / b.low, a.high / b.high}; }
  friend Twice fabs(Twice a) { return {fabs(a.low), fabs(a.high)}; }
  friend Twice sqrt(Twice a) { return {sqrt(a.low), sqrt(a.high)}; }
  friend Twice copysign(Twice magnitude, Twice sign) {
    return {copysign(magnitude.low, sign.low), copysign(magnitude.high, sign.high)};
  }
};

#ifdef __AVX512F__

struct Double8 {
  static constexpr std::size_t kLanes = 8;
  __m512d v;

  Double8() = default;
  Double8(__m512d lanes) : v(lanes) {}
  Double8(double every) : v(_mm512_set1_pd(every)) {}
  static Double8 load(const double* aligned) { return {_mm512_load_pd(aligned)}; }
  // at(i), a float or a double, in lane i.
  template <typename At>
  static Double8 of(const At& at) {
    if constexpr (std::is_same_v<decltype(at(0)), float>)
      return {_mm512_cvtps_pd(
          _mm256_set_m128(_mm_setr_ps(at(4), at(5), at(6), at(7)), _mm_setr_ps(at(0), at(1), at(2), at(3))))};
    else
      return {_mm512_setr_pd(at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7))};
  }
  void store(double* aligned) const { _mm512_store_pd(aligned, v); }
  // Rounded to float.
  void store(float* aligned) const { _mm256_store_ps(aligned, _mm512_cvtpd_ps(v)); }
};

inline Double8 operator+(Double8 a, Double8 b) {
  return {_mm512_add_pd(a.v, b.v)};
}
inline Double8 operator-(Double8 a, Double8 b) {
  return {_mm512_sub_pd(a.v, b.v)};
}
inline Double8 operator-(Double8 a) {
  return {_mm512_xor_pd(a.v, _mm512_set1_pd(-0.0))};
}
inline Double8 operator*(Double8 a, Double8 b) {
  return {_mm512_mul_pd(a.v, b.v)};
}
inline Double8 operator/(Double8 a, Double8 b) {
  return {_mm512_div_pd(a.v, b.v)};
}
inline Double8 fabs(Double8 a) {
  return {_mm512_abs_pd(a.v)};
}
inline Double8 sqrt(Double8 a) {
  return {_mm512_sqrt_pd(a.v)};
}
inline Double8 copysign(Double8 magnitude, Double8 sign) {
  return {_mm512_or_pd(fabs(magnitude).v, _mm512_and_pd(_mm512_set1_pd(-0.0), sign.v))};
}
// a * b - c and c - a * b, rounded once.
inline Double8 multiply_subtract(Double8 a, Double8 b, Double8 c) {
  return {_mm512_fmsub_pd(a.v, b.v, c.v)};
}
inline Double8 negative_multiply_add(Double8 a, Double8 b, Double8 c) {
  return {_mm512_fnmadd_pd(a.v, b.v, c.v)};
}
// `a` in the lanes whose bits are set, else `b`.
inline Double8 select(unsigned bits, Double8 a, Double8 b) {
  return {_mm512_mask_blend_pd(static_cast<__mmask8>(bits), b.v, a.v)};
}
inline Mask8 operator<(Double8 a, Double8 b) {
  return Mask8::from_mask(_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ));
}
inline Mask8 operator>=(Double8 a, Double8 b) {
  return Mask8::from_mask(_mm512_cmp_pd_mask(a.v, b.v, _CMP_GE_OQ));
}
inline Double8 select(Mask8 mask, Double8 a, Double8 b) {
  return {_mm512_mask_blend_pd(mask.mask(), b.v, a.v)};
}

inline Double8 widened(Float8 a) {
  return {_mm512_cvtps_pd(a.v)};
}
inline Float8 to_float(Double8 a) {
  return _mm512_cvtpd_ps(a.v);
}

#else

using Double8 = Twice<Double4>;

inline Double8 widened(Float8 a) {
  return {_mm256_cvtps_pd(_mm256_castps256_ps128(a.v)), _mm256_cvtps_pd(_mm256_extractf128_ps(a.v, 1))};
}
inline Float8 to_float(Double8 a) {
  return _mm256_set_m128(_mm256_cvtpd_ps(a.high.v), _mm256_cvtpd_ps(a.low.v));
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

#endif

inline Mask8 operator>(Double8 a, Double8 b) {
  return b < a;
}

template <>
struct Lanes<Float8> {
  using Mask = Mask8;
  using Wide = Double8;
  static constexpr int kCount = 8;
};

}  // namespace tessera::core
