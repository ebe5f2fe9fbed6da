// SPDX-License-Identifier: Apache-2.0
// Eight floats, and four or eight doubles. Each lane is rounded like the scalar operation, so both
// forms of a formula give the same bits. Comparisons with NaN are false, except for !=.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/math/lanes.hpp"
#include "core/math/vector_instructions.hpp"

namespace tessera::core {

// A boolean in each of eight lanes.
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

#ifdef __AVX512F__
  static Mask8 from_mask(__mmask8 lanes) {
    return _mm256_castsi256_ps(_mm256_movm_epi32(lanes));
  }
  __mmask8 mask() const {
    return _mm256_movepi32_mask(_mm256_castps_si256(v));
  }
#endif
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
// `a` where the mask is set, else `b`.
inline Mask8 select_mask(Mask8 mask, Mask8 a, Mask8 b) {
  return _mm256_blendv_ps(b.v, a.v, mask.v);
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
// `b` if `a` is NaN.
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
// The larger magnitude; neither may be NaN.
inline Float8 max_magnitude(Float8 a, Float8 b) {
  return max(fabs(a), fabs(b));
}
inline Float8 floor(Float8 a) {
  return {_mm256_floor_ps(a.v)};
}
// Rounds to the nearest integer, ties to even.
inline Float8 nearbyint(Float8 a) {
  return {_mm256_round_ps(a.v, _MM_FROUND_TO_NEAREST_INT)};
}
// Whether the sign bit of each lane is set.
inline Mask8 signbit(Float8 a) {
  return _mm256_castsi256_ps(_mm256_srai_epi32(_mm256_castps_si256(a.v), 31));
}
inline Float8 copysign(Float8 magnitude, Float8 sign) {
  return _mm256_or_ps(fabs(magnitude).v, _mm256_and_ps(_mm256_set1_ps(-0.0f), sign.v));
}
// a * b + c, a * b - c and c - a * b, rounded once.
inline Float8 multiply_add(Float8 a, Float8 b, Float8 c) {
  return {fused_multiply_add(a.v, b.v, c.v)};
}
inline Float8 multiply_subtract(Float8 a, Float8 b, Float8 c) {
  return {fused_multiply_subtract(a.v, b.v, c.v)};
}
inline Float8 negative_multiply_add(Float8 a, Float8 b, Float8 c) {
  return {fused_negative_multiply_add(a.v, b.v, c.v)};
}
// `a` where the mask is set, else `b`.
inline Float8 select(Mask8 mask, Float8 a, Float8 b) {
  return {_mm256_blendv_ps(b.v, a.v, mask.v)};
}
// The minimum of all lanes; unspecified if any is NaN.
inline float least(Float8 a) {
  const __m128 of_four = _mm_min_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
  const __m128 of_two = _mm_min_ps(of_four, _mm_movehl_ps(of_four, of_four));
  return _mm_cvtss_f32(_mm_min_ss(of_two, _mm_movehdup_ps(of_two)));
}
inline unsigned less_equal(Float8 a, Float8 b) {
  return (a <= b).bits();
}

// Bit i is the sign of from[i].
inline unsigned signs_of_four(const float* from) {
  return static_cast<unsigned>(_mm_movemask_ps(_mm_loadu_ps(from)));
}

// Transposes: row_at(i)[d] becomes columns[d][i], for four columns and rows; columns are aligned to 16
// bytes.
template <typename RowAt>
void store_transposed(const std::array<const float*, 4>& columns, const RowAt& row_at) {
  __m128 a = _mm_load_ps(columns[0]), b = _mm_load_ps(columns[1]), c = _mm_load_ps(columns[2]),
         d = _mm_load_ps(columns[3]);
  _MM_TRANSPOSE4_PS(a, b, c, d);
  _mm_storeu_ps(row_at(0), a), _mm_storeu_ps(row_at(1), b), _mm_storeu_ps(row_at(2), c),
      _mm_storeu_ps(row_at(3), d);
}

// Transposes eight rows of four: lane i of result d is row_at(i)[d]. Always inlined, because the results
// would otherwise pass through memory.
template <typename RowAt>
[[gnu::always_inline]] inline std::array<Float8, 4> transposed(const RowAt& row_at) {
  const auto pair = [&row_at](std::size_t i) {  // rows i and i + 4
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row_at(i))), _mm_loadu_ps(row_at(i + 4)),
                                1);
  };
  const __m256 a = pair(0), b = pair(1), c = pair(2), d = pair(3);
  const __m256d ab_low = _mm256_castps_pd(_mm256_unpacklo_ps(a, b)),
                ab_high = _mm256_castps_pd(_mm256_unpackhi_ps(a, b)),
                cd_low = _mm256_castps_pd(_mm256_unpacklo_ps(c, d)),
                cd_high = _mm256_castps_pd(_mm256_unpackhi_ps(c, d));
  return {_mm256_castpd_ps(_mm256_unpacklo_pd(ab_low, cd_low)),
          _mm256_castpd_ps(_mm256_unpackhi_pd(ab_low, cd_low)),
          _mm256_castpd_ps(_mm256_unpacklo_pd(ab_high, cd_high)),
          _mm256_castpd_ps(_mm256_unpackhi_pd(ab_high, cd_high))};
}

// Transposes bits: bit k of rows[i] becomes bit i of columns[k]. There are 64 rows, aligned to 32 bytes,
// and eight columns.
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
  static constexpr std::size_t kLanes = 4;
  __m256d v;

  Double4() = default;
  Double4(__m256d lanes) : v(lanes) {}
  Double4(double every) : v(_mm256_set1_pd(every)) {}
  // at(i), a float or a double, in lane i.
  template <typename At>
  static Double4 of(const At& at) {
    if constexpr (std::is_same_v<decltype(at(0)), float>)
      return {_mm256_cvtps_pd(_mm_setr_ps(at(0), at(1), at(2), at(3)))};
    else
      return {_mm256_setr_pd(at(0), at(1), at(2), at(3))};
  }
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
// `b` if `a` is NaN.
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
inline Double4 fabs(Double4 a) {
  return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v)};
}
inline Double4 sqrt(Double4 a) {
  return {_mm256_sqrt_pd(a.v)};
}
inline Double4 copysign(Double4 magnitude, Double4 sign) {
  return {_mm256_or_pd(fabs(magnitude).v, _mm256_and_pd(_mm256_set1_pd(-0.0), sign.v))};
}
// a * b - c and c - a * b, rounded once.
inline Double4 multiply_subtract(Double4 a, Double4 b, Double4 c) {
  return {fused_multiply_subtract(a.v, b.v, c.v)};
}
inline Double4 negative_multiply_add(Double4 a, Double4 b, Double4 c) {
  return {fused_negative_multiply_add(a.v, b.v, c.v)};
}
// `a` in the lanes whose bits are set, else `b`.
inline Double4 select(unsigned bits, Double4 a, Double4 b) {
  const __m256i bit_of_lane = _mm256_setr_epi64x(1, 2, 4, 8);
  const __m256i set = _mm256_and_si256(_mm256_set1_epi64x(bits), bit_of_lane);
  return {_mm256_blendv_pd(b.v, a.v, _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, bit_of_lane)))};
}
inline unsigned less(Double4 a, Double4 b) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)));
}

}  // namespace tessera::core
