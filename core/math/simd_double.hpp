// SPDX-License-Identifier: Apache-2.0
// Vectors of doubles: the double-precision counterpart of FloatN. One register with AVX-512, else two.
#pragma once

#include "core/math/simd.hpp"

namespace tessera::core {

// The lanes of two vectors of doubles.
template <typename Half>
struct alignas(2 * alignof(Half)) Twice {  // as wide vectors are, so that layouts do not differ
  static constexpr std::size_t kLanes = 2 * Half::kLanes;
  Half low, high;

  Twice() = default;
  Twice(Half first_half, Half second_half) : low(first_half), high(second_half) {}
  Twice(double every) : low(every), high(every) {}
  // at(i), a float or a double, in lane i.
  template <typename At>
  static Twice of(const At& at) {
    return {Half::of(at), Half::of([&at](std::size_t i) { return at(Half::kLanes + i); })};
  }
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
  friend Twice nearbyint(Twice a) { return {nearbyint(a.low), nearbyint(a.high)}; }
  friend Twice power_of_two(Twice a) { return {power_of_two(a.low), power_of_two(a.high)}; }
  friend Twice exponent_near_one(Twice a) { return {exponent_near_one(a.low), exponent_near_one(a.high)}; }
  friend Twice mantissa_near_one(Twice a) { return {mantissa_near_one(a.low), mantissa_near_one(a.high)}; }
  friend Twice copysign(Twice magnitude, Twice sign) {
    return {copysign(magnitude.low, sign.low), copysign(magnitude.high, sign.high)};
  }
};

#ifdef __AVX512F__

struct DoubleN {
  static constexpr std::size_t kLanes = kLaneCount;
  __m512d v;

  DoubleN() = default;
  DoubleN(__m512d lanes) : v(lanes) {}
  DoubleN(double every) : v(_mm512_set1_pd(every)) {}
  static DoubleN load(const double* aligned) { return {_mm512_load_pd(aligned)}; }
  // at(i), a float or a double, in lane i.
  template <typename At>
  static DoubleN of(const At& at) {
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

inline DoubleN operator+(DoubleN a, DoubleN b) {
  return {_mm512_add_pd(a.v, b.v)};
}
inline DoubleN operator-(DoubleN a, DoubleN b) {
  return {_mm512_sub_pd(a.v, b.v)};
}
inline DoubleN operator-(DoubleN a) {
  return {_mm512_xor_pd(a.v, _mm512_set1_pd(-0.0))};
}
inline DoubleN operator*(DoubleN a, DoubleN b) {
  return {_mm512_mul_pd(a.v, b.v)};
}
inline DoubleN operator/(DoubleN a, DoubleN b) {
  return {_mm512_div_pd(a.v, b.v)};
}
inline DoubleN fabs(DoubleN a) {
  return {_mm512_abs_pd(a.v)};
}
inline DoubleN sqrt(DoubleN a) {
  return {_mm512_sqrt_pd(a.v)};
}
inline DoubleN nearbyint(DoubleN a) {
  return {_mm512_roundscale_pd(a.v, _MM_FROUND_TO_NEAREST_INT)};
}
inline DoubleN copysign(DoubleN magnitude, DoubleN sign) {
  return {_mm512_or_pd(fabs(magnitude).v, _mm512_and_pd(_mm512_set1_pd(-0.0), sign.v))};
}
// As for double (core/math/lanes.hpp).
inline DoubleN power_of_two(DoubleN k) {
  const __m512d biased = _mm512_add_pd(k.v, _mm512_set1_pd(kExponentMagic));
  return {_mm512_castsi512_pd(_mm512_slli_epi64(_mm512_castpd_si512(biased), 52))};
}
inline __m512i bits_above_sqrt_half(DoubleN x) {
  return _mm512_sub_epi64(_mm512_castpd_si512(x.v), _mm512_castpd_si512(_mm512_set1_pd(kSqrtHalf)));
}
inline DoubleN exponent_near_one(DoubleN x) {
  return {_mm512_cvtepi64_pd(_mm512_srai_epi64(bits_above_sqrt_half(x), 52))};
}
inline DoubleN mantissa_near_one(DoubleN x) {
  const __m512i exponent = _mm512_slli_epi64(_mm512_srli_epi64(bits_above_sqrt_half(x), 52), 52);
  return {_mm512_castsi512_pd(_mm512_sub_epi64(_mm512_castpd_si512(x.v), exponent))};
}
// a * b - c and c - a * b, rounded once.
inline DoubleN multiply_subtract(DoubleN a, DoubleN b, DoubleN c) {
  return {_mm512_fmsub_pd(a.v, b.v, c.v)};
}
inline DoubleN negative_multiply_add(DoubleN a, DoubleN b, DoubleN c) {
  return {_mm512_fnmadd_pd(a.v, b.v, c.v)};
}
// `a` in the lanes whose bits are set, else `b`.
inline DoubleN select(unsigned bits, DoubleN a, DoubleN b) {
  return {_mm512_mask_blend_pd(static_cast<__mmask8>(bits), b.v, a.v)};
}
inline MaskN operator<(DoubleN a, DoubleN b) {
  return MaskN::from_mask(_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ));
}
inline MaskN operator>=(DoubleN a, DoubleN b) {
  return MaskN::from_mask(_mm512_cmp_pd_mask(a.v, b.v, _CMP_GE_OQ));
}
inline DoubleN select(MaskN mask, DoubleN a, DoubleN b) {
  return {_mm512_mask_blend_pd(mask.mask(), b.v, a.v)};
}

inline DoubleN widened(FloatN a) {
  return {_mm512_cvtps_pd(a.v)};
}
inline FloatN to_float(DoubleN a) {
  return _mm512_cvtpd_ps(a.v);
}

#else

using DoubleN = Twice<DoubleHalf>;

inline DoubleN widened(FloatN a) {
  return {_mm256_cvtps_pd(_mm256_castps256_ps128(a.v)), _mm256_cvtps_pd(_mm256_extractf128_ps(a.v, 1))};
}
inline FloatN to_float(DoubleN a) {
  return _mm256_set_m128(_mm256_cvtpd_ps(a.high.v), _mm256_cvtpd_ps(a.low.v));
}

// The upper halves of 64-bit lanes, which hold all a mask needs.
inline MaskN narrowed(__m256d low, __m256d high) {
  const __m256 mixed =
      _mm256_shuffle_ps(_mm256_castpd_ps(low), _mm256_castpd_ps(high), _MM_SHUFFLE(3, 1, 3, 1));
  return _mm256_castpd_ps(_mm256_permute4x64_pd(_mm256_castps_pd(mixed), _MM_SHUFFLE(3, 1, 2, 0)));
}
inline MaskN operator<(DoubleN a, DoubleN b) {
  return narrowed(_mm256_cmp_pd(a.low.v, b.low.v, _CMP_LT_OQ), _mm256_cmp_pd(a.high.v, b.high.v, _CMP_LT_OQ));
}
inline MaskN operator>=(DoubleN a, DoubleN b) {
  return narrowed(_mm256_cmp_pd(a.low.v, b.low.v, _CMP_GE_OQ), _mm256_cmp_pd(a.high.v, b.high.v, _CMP_GE_OQ));
}
inline DoubleN select(MaskN mask, DoubleN a, DoubleN b) {
  const __m256i lanes = _mm256_castps_si256(mask.v);
  const __m256i low = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(lanes));
  const __m256i high = _mm256_cvtepi32_epi64(_mm256_extracti128_si256(lanes, 1));
  return {_mm256_blendv_pd(b.low.v, a.low.v, _mm256_castsi256_pd(low)),
          _mm256_blendv_pd(b.high.v, a.high.v, _mm256_castsi256_pd(high))};
}

#endif

inline MaskN operator>(DoubleN a, DoubleN b) {
  return b < a;
}
inline MaskN operator==(DoubleN a, DoubleN b) {
  return (a >= b) & (b >= a);
}

template <>
struct Lanes<FloatN> {
  using Mask = MaskN;
  using Wide = DoubleN;
  static constexpr int kCount = kLaneCount;
};

}  // namespace tessera::core
