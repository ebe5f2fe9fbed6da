// SPDX-License-Identifier: Apache-2.0
// FloatVector and its associated types on AVX-512, with twice the lanes of FloatN. Each lane is rounded
// like the scalar operation. Comparisons with NaN are false, except for !=. Include this only in code that
// is compiled for such processors.
#pragma once

#include <cstdint>

#include "core/math/simd_double.hpp"

namespace tessera::core {

// A boolean in each lane.
struct MaskVector {
  __mmask16 v;

  MaskVector() = default;
  MaskVector(__mmask16 lanes) : v(lanes) {}
  MaskVector(bool every) : v(every ? 0xffff : 0) {}
  // Bit i for lane i.
  static MaskVector from_bits(unsigned bits) { return static_cast<__mmask16>(bits); }

  unsigned bits() const { return v; }
};

inline MaskVector operator&(MaskVector a, MaskVector b) {
  return static_cast<__mmask16>(a.v & b.v);
}
inline MaskVector operator|(MaskVector a, MaskVector b) {
  return static_cast<__mmask16>(a.v | b.v);
}
inline MaskVector operator!(MaskVector a) {
  return static_cast<__mmask16>(~a.v);
}
inline bool any(MaskVector mask) {
  return mask.v != 0;
}
inline bool all(MaskVector mask) {
  return mask.v == 0xffff;
}

struct FloatVector {
  __m512 v;

  FloatVector() = default;
  FloatVector(__m512 lanes) : v(lanes) {}
  FloatVector(float every) : v(_mm512_set1_ps(every)) {}
  static FloatVector load(const float* aligned) { return {_mm512_load_ps(aligned)}; }

  void store(float* aligned) const { _mm512_store_ps(aligned, v); }
};

inline FloatVector operator+(FloatVector a, FloatVector b) {
  return {_mm512_add_ps(a.v, b.v)};
}
inline FloatVector operator-(FloatVector a, FloatVector b) {
  return {_mm512_sub_ps(a.v, b.v)};
}
inline FloatVector operator-(FloatVector a) {
  return {_mm512_xor_ps(a.v, _mm512_set1_ps(-0.0f))};
}
inline FloatVector operator*(FloatVector a, FloatVector b) {
  return {_mm512_mul_ps(a.v, b.v)};
}
inline FloatVector operator/(FloatVector a, FloatVector b) {
  return {_mm512_div_ps(a.v, b.v)};
}
inline MaskVector operator<(FloatVector a, FloatVector b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ);
}
inline MaskVector operator<=(FloatVector a, FloatVector b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ);
}
inline MaskVector operator>(FloatVector a, FloatVector b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ);
}
inline MaskVector operator>=(FloatVector a, FloatVector b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ);
}
inline MaskVector operator==(FloatVector a, FloatVector b) {
  return _mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ);
}
// `b` if `a` is NaN.
inline FloatVector max(FloatVector a, FloatVector b) {
  return {_mm512_max_ps(a.v, b.v)};
}
inline FloatVector min(FloatVector a, FloatVector b) {
  return {_mm512_min_ps(a.v, b.v)};
}
inline FloatVector fabs(FloatVector a) {
  return {_mm512_abs_ps(a.v)};
}
// The larger magnitude; neither may be NaN.
inline FloatVector max_magnitude(FloatVector a, FloatVector b) {
  constexpr int kGreaterMagnitude = 0b11, kSignClear = 0b10 << 2;
  return {_mm512_range_ps(a.v, b.v, kGreaterMagnitude | kSignClear)};
}
// Whether the sign bit of each lane is set.
inline MaskVector signbit(FloatVector a) {
  return _mm512_movepi32_mask(_mm512_castps_si512(a.v));
}
// a * b + c, a * b - c and c - a * b, rounded once.
inline FloatVector multiply_add(FloatVector a, FloatVector b, FloatVector c) {
  return {_mm512_fmadd_ps(a.v, b.v, c.v)};
}
inline FloatVector multiply_subtract(FloatVector a, FloatVector b, FloatVector c) {
  return {_mm512_fmsub_ps(a.v, b.v, c.v)};
}
inline FloatVector negative_multiply_add(FloatVector a, FloatVector b, FloatVector c) {
  return {_mm512_fnmadd_ps(a.v, b.v, c.v)};
}
// `a` where the mask is set, else `b`.
inline FloatVector select(MaskVector mask, FloatVector a, FloatVector b) {
  return {_mm512_mask_blend_ps(mask.v, b.v, a.v)};
}
// The minimum of all lanes; unspecified if any is NaN.
inline float least(FloatVector a) {
  return least(min(FloatN(_mm512_castps512_ps256(a.v)), FloatN(_mm512_extractf32x8_ps(a.v, 1))));
}
inline unsigned less_equal(FloatVector a, FloatVector b) {
  return (a <= b).bits();
}

struct U32Vector {
  __m512i v;

  U32Vector() = default;
  U32Vector(__m512i lanes) : v(lanes) {}
  U32Vector(std::uint32_t every) : v(_mm512_set1_epi32(static_cast<int>(every))) {}
};

inline U32Vector operator+(U32Vector a, U32Vector b) {
  return _mm512_add_epi32(a.v, b.v);
}
inline U32Vector operator-(U32Vector a, U32Vector b) {
  return _mm512_sub_epi32(a.v, b.v);
}
inline U32Vector select(MaskVector mask, U32Vector a, U32Vector b) {
  return _mm512_mask_blend_epi32(mask.v, b.v, a.v);
}
inline U32Vector as_bits(FloatVector a) {
  return _mm512_castps_si512(a.v);
}
inline FloatVector as_float(U32Vector a) {
  return _mm512_castsi512_ps(a.v);
}

// The double-precision counterpart of FloatVector.
using DoubleVector = Twice<DoubleN>;

template <>
struct Lanes<FloatVector> {
  using Mask = MaskVector;
  using Wide = DoubleVector;
  static constexpr int kCount = 2 * kLaneCount;
};

inline DoubleVector widened(FloatVector a) {
  return {_mm512_cvtps_pd(_mm512_castps512_ps256(a.v)), _mm512_cvtps_pd(_mm512_extractf32x8_ps(a.v, 1))};
}
inline FloatVector to_float(DoubleVector a) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(to_float(a.low).v), to_float(a.high).v, 1);
}

template <int kPredicate>
MaskVector compare(DoubleVector a, DoubleVector b) {
  return _mm512_kunpackb(_mm512_cmp_pd_mask(a.high.v, b.high.v, kPredicate),
                         _mm512_cmp_pd_mask(a.low.v, b.low.v, kPredicate));
}
inline MaskVector operator<(DoubleVector a, DoubleVector b) {
  return compare<_CMP_LT_OQ>(a, b);
}
inline MaskVector operator>(DoubleVector a, DoubleVector b) {
  return compare<_CMP_GT_OQ>(a, b);
}
inline MaskVector operator>=(DoubleVector a, DoubleVector b) {
  return compare<_CMP_GE_OQ>(a, b);
}
inline DoubleVector select(MaskVector mask, DoubleVector a, DoubleVector b) {
  return {_mm512_mask_blend_pd(static_cast<__mmask8>(mask.v), b.low.v, a.low.v),
          _mm512_mask_blend_pd(static_cast<__mmask8>(mask.v >> 8), b.high.v, a.high.v)};
}

}  // namespace tessera::core
