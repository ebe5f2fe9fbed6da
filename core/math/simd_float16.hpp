// SPDX-License-Identifier: Apache-2.0
// Sixteen floats and their associated types, on AVX-512. Each lane is rounded like the scalar operation.
// Comparisons with NaN are false, except for !=. Include this only in code that is compiled for such
// processors.
#pragma once

#include <cstdint>

#include "core/math/simd_double8.hpp"

namespace tessera::core {

// A boolean in each of sixteen lanes.
struct Mask16 {
  __mmask16 v;

  Mask16() = default;
  Mask16(__mmask16 lanes) : v(lanes) {}
  Mask16(bool every) : v(every ? 0xffff : 0) {}
  // Bit i for lane i.
  static Mask16 from_bits(unsigned bits) { return static_cast<__mmask16>(bits); }

  unsigned bits() const { return v; }
};

inline Mask16 operator&(Mask16 a, Mask16 b) {
  return static_cast<__mmask16>(a.v & b.v);
}
inline Mask16 operator|(Mask16 a, Mask16 b) {
  return static_cast<__mmask16>(a.v | b.v);
}
inline Mask16 operator!(Mask16 a) {
  return static_cast<__mmask16>(~a.v);
}
inline bool any(Mask16 mask) {
  return mask.v != 0;
}
inline bool all(Mask16 mask) {
  return mask.v == 0xffff;
}

struct Float16 {
  __m512 v;

  Float16() = default;
  Float16(__m512 lanes) : v(lanes) {}
  Float16(float every) : v(_mm512_set1_ps(every)) {}
  static Float16 load(const float* aligned) { return {_mm512_load_ps(aligned)}; }

  void store(float* aligned) const { _mm512_store_ps(aligned, v); }
};

inline Float16 operator+(Float16 a, Float16 b) {
  return {_mm512_add_ps(a.v, b.v)};
}
inline Float16 operator-(Float16 a, Float16 b) {
  return {_mm512_sub_ps(a.v, b.v)};
}
inline Float16 operator-(Float16 a) {
  return {_mm512_xor_ps(a.v, _mm512_set1_ps(-0.0f))};
}
inline Float16 operator*(Float16 a, Float16 b) {
  return {_mm512_mul_ps(a.v, b.v)};
}
inline Float16 operator/(Float16 a, Float16 b) {
  return {_mm512_div_ps(a.v, b.v)};
}
inline Mask16 operator<(Float16 a, Float16 b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ);
}
inline Mask16 operator<=(Float16 a, Float16 b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ);
}
inline Mask16 operator>(Float16 a, Float16 b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ);
}
inline Mask16 operator>=(Float16 a, Float16 b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ);
}
inline Mask16 operator==(Float16 a, Float16 b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ);
}
// `b` if `a` is NaN.
inline Float16 max(Float16 a, Float16 b) {
  return {_mm512_max_ps(a.v, b.v)};
}
inline Float16 min(Float16 a, Float16 b) {
  return {_mm512_min_ps(a.v, b.v)};
}
inline Float16 fabs(Float16 a) {
  return {_mm512_abs_ps(a.v)};
}
// The larger magnitude; neither may be NaN.
inline Float16 max_magnitude(Float16 a, Float16 b) {
  constexpr int kGreaterMagnitude = 0b11, kSignClear = 0b10 << 2;
  return {_mm512_range_ps(a.v, b.v, kGreaterMagnitude | kSignClear)};
}
// Whether the sign bit of each lane is set.
inline Mask16 signbit(Float16 a) {
  return _mm512_movepi32_mask(_mm512_castps_si512(a.v));
}
// a * b + c, a * b - c and c - a * b, rounded once.
inline Float16 multiply_add(Float16 a, Float16 b, Float16 c) {
  return {_mm512_fmadd_ps(a.v, b.v, c.v)};
}
inline Float16 multiply_subtract(Float16 a, Float16 b, Float16 c) {
  return {_mm512_fmsub_ps(a.v, b.v, c.v)};
}
inline Float16 negative_multiply_add(Float16 a, Float16 b, Float16 c) {
  return {_mm512_fnmadd_ps(a.v, b.v, c.v)};
}
// `a` where the mask is set, else `b`.
inline Float16 select(Mask16 mask, Float16 a, Float16 b) {
  return {_mm512_mask_blend_ps(mask.v, b.v, a.v)};
}
// The minimum of all lanes; unspecified if any is NaN.
inline float least(Float16 a) {
  return least(min(Float8(_mm512_castps512_ps256(a.v)), Float8(_mm512_extractf32x8_ps(a.v, 1))));
}
inline unsigned less_equal(Float16 a, Float16 b) {
  return (a <= b).bits();
}

struct U32x16 {
  __m512i v;

  U32x16() = default;
  U32x16(__m512i lanes) : v(lanes) {}
  U32x16(std::uint32_t every) : v(_mm512_set1_epi32(static_cast<int>(every))) {}
};

inline U32x16 operator+(U32x16 a, U32x16 b) {
  return _mm512_add_epi32(a.v, b.v);
}
inline U32x16 operator-(U32x16 a, U32x16 b) {
  return _mm512_sub_epi32(a.v, b.v);
}
inline U32x16 select(Mask16 mask, U32x16 a, U32x16 b) {
  return _mm512_mask_blend_epi32(mask.v, b.v, a.v);
}
inline U32x16 as_bits(Float16 a) {
  return _mm512_castps_si512(a.v);
}
inline Float16 as_float(U32x16 a) {
  return _mm512_castsi512_ps(a.v);
}

// The double-precision counterpart of Float16.
using Double16 = Twice<Double8>;

template <>
struct Lanes<Float16> {
  using Mask = Mask16;
  using Wide = Double16;
  static constexpr int kCount = 16;
};

inline Double16 widened(Float16 a) {
  return {_mm512_cvtps_pd(_mm512_castps512_ps256(a.v)), _mm512_cvtps_pd(_mm512_extractf32x8_ps(a.v, 1))};
}
inline Float16 to_float(Double16 a) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(to_float(a.low).v), to_float(a.high).v, 1);
}

template <int kPredicate>
Mask16 compare(Double16 a, Double16 b) {
  return _mm512_kunpackb(_mm512_cmp_pd_mask(a.high.v, b.high.v, kPredicate),
                         _mm512_cmp_pd_mask(a.low.v, b.low.v, kPredicate));
}
inline Mask16 operator<(Double16 a, Double16 b) {
  return compare<_CMP_LT_OQ>(a, b);
}
inline Mask16 operator>(Double16 a, Double16 b) {
  return compare<_CMP_GT_OQ>(a, b);
}
inline Mask16 operator>=(Double16 a, Double16 b) {
  return compare<_CMP_GE_OQ>(a, b);
}
inline Double16 select(Mask16 mask, Double16 a, Double16 b) {
  return {_mm512_mask_blend_pd(static_cast<__mmask8>(mask.v), b.low.v, a.low.v),
          _mm512_mask_blend_pd(static_cast<__mmask8>(mask.v >> 8), b.high.v, a.high.v)};
}

}  // namespace tessera::core
