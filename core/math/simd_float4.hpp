// Four floats and four whole numbers at once: halves of a Float8, for what is about points and boxes, three
// lanes of which are coordinates.
#pragma once

#include "core/math/simd.hpp"

namespace tessera::core {

struct Float4 {
  __m128 v;

  static Float4 broadcast(float x) { return {_mm_set1_ps(x)}; }
  static Float4 of(float x, float y, float z, float w) { return {_mm_setr_ps(x, y, z, w)}; }
  void store(float* aligned) const { _mm_store_ps(aligned, v); }
};

inline Float4 operator+(Float4 a, Float4 b) {
  return {_mm_add_ps(a.v, b.v)};
}
inline Float4 operator-(Float4 a, Float4 b) {
  return {_mm_sub_ps(a.v, b.v)};
}
inline Float4 operator*(Float4 a, Float4 b) {
  return {_mm_mul_ps(a.v, b.v)};
}
inline Float4 lower_half(Float8 a) {
  return {_mm256_castps256_ps128(a.v)};
}
inline Float4 upper_half(Float8 a) {
  return {_mm256_extractf128_ps(a.v, 1)};
}
inline Float8 join(Float4 lower, Float4 upper) {
  return {_mm256_set_m128(upper.v, lower.v)};
}
// Of the first three lanes: xy + yz + zx.
inline float sum_of_products_in_pairs(Float4 a) {
  const __m128 products = _mm_mul_ps(a.v, _mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(3, 0, 2, 1)));
  const __m128 y = _mm_movehdup_ps(products), z = _mm_movehl_ps(products, products);
  return _mm_cvtss_f32(_mm_add_ss(_mm_add_ss(products, y), z));
}

// Four whole numbers.
struct Int4 {
  __m128i v;

  static Int4 broadcast(int x) { return {_mm_set1_epi32(x)}; }
  // Towards 0; the least of all where that does not fit, or is NaN.
  static Int4 truncated(Float4 a) { return {_mm_cvttps_epi32(a.v)}; }
  void store(int* aligned) const { _mm_store_si128(reinterpret_cast<__m128i*>(aligned), v); }
};

inline Int4 clamp(Int4 a, Int4 low, Int4 high) {
  return {_mm_min_epi32(_mm_max_epi32(a.v, low.v), high.v)};
}
inline unsigned less(Int4 a, Int4 b) {
  return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(_mm_cmplt_epi32(a.v, b.v))));
}

// 0 in lane 3, the others as they are.
inline Float8 without_lane_3(Float8 a) {
  return {_mm256_blend_ps(a.v, _mm256_setzero_ps(), 1 << 3)};
}

}  // namespace tessera::core
