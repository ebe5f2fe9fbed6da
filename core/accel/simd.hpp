// Eight floats and four doubles at once, on AVX2. Each lane is rounded as the scalar operation is, so that
// the same formula gives the same bits in either form. Comparisons answer with one bit for each lane and are
// false for NaN.
#pragma once

#include <immintrin.h>

namespace tessera::core {

struct Float8 {
  __m256 v;

  static Float8 broadcast(float x) { return {_mm256_set1_ps(x)}; }
  static Float8 load(const float* aligned) { return {_mm256_load_ps(aligned)}; }
  void store(float* aligned) const { _mm256_store_ps(aligned, v); }
};

inline Float8 operator-(Float8 a, Float8 b) {
  return {_mm256_sub_ps(a.v, b.v)};
}
inline Float8 operator*(Float8 a, Float8 b) {
  return {_mm256_mul_ps(a.v, b.v)};
}
// Where `a` is NaN, `b`.
inline Float8 max(Float8 a, Float8 b) {
  return {_mm256_max_ps(a.v, b.v)};
}
inline Float8 min(Float8 a, Float8 b) {
  return {_mm256_min_ps(a.v, b.v)};
}
inline unsigned less_equal(Float8 a, Float8 b) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)));
}

struct Double4 {
  __m256d v;

  static Double4 broadcast(double x) { return {_mm256_set1_pd(x)}; }
  static Double4 load(const float* aligned) { return {_mm256_cvtps_pd(_mm_load_ps(aligned))}; }
  void store(double* aligned) const { _mm256_store_pd(aligned, v); }
};

inline Double4 operator-(Double4 a, Double4 b) {
  return {_mm256_sub_pd(a.v, b.v)};
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
