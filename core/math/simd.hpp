// Eight floats, and four or eight doubles, at once on AVX2. Each lane is rounded as the scalar operation is,
// so that the same formula gives the same bits in either form. Comparisons are false for NaN, but for !=.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "core/math/lanes.hpp"

namespace tessera::core {

// Yes or no for each of eight lanes.
struct Mask8 {
  __m256 v;

  Mask8() = default;
  Mask8(__m256 lanes) : v(lanes) {}
  Mask8(bool every) : v(_mm256_castsi256_ps(_mm256_set1_epi32(every ? -1 : 0))) {}
  // Bit i for lane i.
  static Mask8 from_bits(unsigned bits) {
    const __m256i bit_of_lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i set = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), bit_of_lane);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit_of_lane));
  }

  unsigned bits() const { return static_cast<unsigned>(_mm256_movemask_ps(v)); }
};

inline Mask8 operator&(Mask8 a, Mask8 b) {
  return _mm256_and_ps(a.v, b.v);
}
inline Mask8 operator|(Mask8 a, Mask8 b) {
  return _mm256_or_ps(a.v, b.v);
}
inline Mask8 operator!(Mask8 a) {
  return _mm256_xor_ps(a.v, Mask8(true).v);
}
inline bool any(Mask8 mask) {
  return mask.bits() != 0;
}
inline bool all(Mask8 mask) {
  return mask.bits() == 0xff;
}

struct Float8 {
  __m256 v;

  Float8() = default;
  Float8(__m256 lanes) : v(lanes) {}
  Float8(float every) : v(_mm256_set1_ps(every)) {}
  static Float8 broadcast(float x) { return {_mm256_set1_ps(x)}; }
  static Float8 load(const float* aligned) { return {_mm256_load_ps(aligned)}; }
  static Float8 load_unaligned(const float* from) { return {_mm256_loadu_ps(from)}; }
  // table[index[i]] in lane i.
  static Float8 gather(const float* table, __m256i index) { return _mm256_i32gather_ps(table, index, 4); }

  void store(float* aligned) const { _mm256_store_ps(aligned, v); }
  void store_unaligned(float* to) const { _mm256_storeu_ps(to, v); }
};

inline Float8 operator+(Float8 a, Float8 b) {
  return {_mm256_add_ps(a.v, b.v)};
}
inline Float8 operator-(Float8 a, Float8 b) {
  return {_mm256_sub_ps(a.v, b.v)};
}
inline Float8 operator-(Float8 a) {
  return {_mm256_xor_ps(a.v, _mm256_set1_ps(-0.0f))};
}
inline Float8 operator*(Float8 a, Float8 b) {
  return {_mm256_mul_ps(a.v, b.v)};
}
inline Float8 operator/(Float8 a, Float8 b) {
  return {_mm256_div_ps(a.v, b.v)};
}
inline Mask8 operator<(Float8 a, Float8 b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ);
}
inline Mask8 operator<=(Float8 a, Float8 b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ);
}
inline Mask8 operator>(Float8 a, Float8 b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ);
}
inline Mask8 operator>=(Float8 a, Float8 b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_GE_OQ);
}
inline Mask8 operator==(Float8 a, Float8 b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ);
}
inline Mask8 operator!=(Float8 a, Float8 b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_NEQ_UQ);
}
// Where `a` is NaN, `b`.
inline Float8 max(Float8 a, Float8 b) {
  return {_mm256_max_ps(a.v, b.v)};
}
inline Float8 min(Float8 a, Float8 b) {
  return {_mm256_min_ps(a.v, b.v)};
}
inline Float8 sqrt(Float8 a) {
  return {_mm256_sqrt_ps(a.v)};
}
inline Float8 fabs(Float8 a) {
  return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)};
}
inline Float8 floor(Float8 a) {
  return {_mm256_floor_ps(a.v)};
}
// To the nearest whole number, halves to the even one.
inline Float8 nearbyint(Float8 a) {
  return {_mm256_round_ps(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)};
}
// Of each lane, whether its sign bit is set.
inline Mask8 signbit(Float8 a) {
  return _mm256_castsi256_ps(_mm256_srai_epi32(_mm256_castps_si256(a.v), 31));
}
inline Float8 copysign(Float8 magnitude, Float8 sign) {
  return _mm256_or_ps(fabs(magnitude).v, _mm256_and_ps(_mm256_set1_ps(-0.0f), sign.v));
}
// a * b + c, a * b - c and c - a * b, rounded once.
inline Float8 multiply_add(Float8 a, Float8 b, Float8 c) {
  return {_mm256_fmadd_ps(a.v, b.v, c.v)};
}
inline Float8 multiply_subtract(Float8 a, Float8 b, Float8 c) {
  return {_mm256_fmsub_ps(a.v, b.v, c.v)};
}
inline Float8 negative_multiply_add(Float8 a, Float8 b, Float8 c) {
  return {_mm256_fnmadd_ps(a.v, b.v, c.v)};
}
// `a` where the mask says yes, else `b`.
inline Float8 select(Mask8 mask, Float8 a, Float8 b) {
  return {_mm256_blendv_ps(b.v, a.v, mask.v)};
}
inline unsigned less_equal(Float8 a, Float8 b) {
  return (a <= b).bits();
}

// Bit k of rows[i] becomes bit i of columns[k]; rows are 64, aligned to 32 bytes, and columns eight.
inline void transpose_bits(const std::uint8_t* rows, std::uint64_t* columns) {
  __m256i first = _mm256_load_si256(reinterpret_cast<const __m256i*>(rows));
  __m256i second = _mm256_load_si256(reinterpret_cast<const __m256i*>(rows + 32));
  for (int k = 7; k >= 0; --k) {
    const auto low = static_cast<std::uint32_t>(_mm256_movemask_epi8(first));
    const auto high = static_cast<std::uint32_t>(_mm256_movemask_epi8(second));
    columns[k] = std::uint64_t{high} << 32 | low;
    first = _mm256_add_epi8(first, first);
    second = _mm256_add_epi8(second, second);
  }
}

struct Double4 {
  __m256d v;

  Double4() = default;
  Double4(__m256d lanes) : v(lanes) {}
  Double4(double every) : v(_mm256_set1_pd(every)) {}
  static Double4 broadcast(double x) { return {_mm256_set1_pd(x)}; }
  static Double4 of(double a, double b, double c, double d) { return {_mm256_setr_pd(a, b, c, d)}; }
  static Double4 of(float a, float b, float c, float d) { return {_mm256_cvtps_pd(_mm_setr_ps(a, b, c, d))}; }
  static Double4 load(const float* aligned) { return {_mm256_cvtps_pd(_mm_load_ps(aligned))}; }
  static Double4 load(const double* aligned) { return {_mm256_load_pd(aligned)}; }
  void store(double* aligned) const { _mm256_store_pd(aligned, v); }
  // Rounded to float.
  void store(float* aligned) const { _mm_store_ps(aligned, _mm256_cvtpd_ps(v)); }
};

inline Double4 operator-(Double4 a, Double4 b) {
  return {_mm256_sub_pd(a.v, b.v)};
}
inline Double4 operator-(Double4 a) {
  return {_mm256_xor_pd(a.v, _mm256_set1_pd(-0.0))};
}
inline Double4 operator*(Double4 a, Double4 b) {
  return {_mm256_mul_pd(a.v, b.v)};
}
// Where `a` is NaN, `b`.
inline Double4 max(Double4 a, Double4 b) {
  return {_mm256_max_pd(a.v, b.v)};
}
inline Double4 min(Double4 a, Double4 b) {
  return {_mm256_min_pd(a.v, b.v)};
}
inline Double4 operator+(Double4 a, Double4 b) {
  return {_mm256_add_pd(a.v, b.v)};
}
inline Double4 operator/(Double4 a, Double4 b) {
  return {_mm256_div_pd(a.v, b.v)};
}
inline Double4 abs(Double4 a) {
  return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v)};
}
inline Double4 sqrt(Double4 a) {
  return {_mm256_sqrt_pd(a.v)};
}
inline Double4 copysign(Double4 magnitude, Double4 sign) {
  return {_mm256_or_pd(abs(magnitude).v, _mm256_and_pd(_mm256_set1_pd(-0.0), sign.v))};
}
// To the nearest whole number, halves to the even one.
inline Double4 nearbyint(Double4 a) {
  return {_mm256_round_pd(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)};
}
// a * b - c and c - a * b, rounded once.
inline Double4 multiply_subtract(Double4 a, Double4 b, Double4 c) {
  return {_mm256_fmsub_pd(a.v, b.v, c.v)};
}
inline Double4 negative_multiply_add(Double4 a, Double4 b, Double4 c) {
  return {_mm256_fnmadd_pd(a.v, b.v, c.v)};
}
inline unsigned less(Double4 a, Double4 b) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)));
}

}  // namespace tessera::core
