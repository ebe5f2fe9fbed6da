// SPDX-License-Identifier: Apache-2.0
// Vectors of kLaneCount floats, and of half as many doubles. Each lane is rounded like the scalar operation,
// so both forms of a formula give the same bits. Comparisons with NaN are false, except for !=.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/math/lanes.hpp"
#include "core/math/vector_instructions.hpp"

namespace tessera::core {

// The number of lanes of FloatN, MaskN, DoubleN, U32xN and U64xN.
inline constexpr std::size_t kLaneCount = 8;

// A boolean in each lane.
struct MaskN {
  __m256 v;

  MaskN() = default;
  MaskN(__m256 lanes) : v(lanes) {}
  MaskN(bool every) : v(_mm256_castsi256_ps(_mm256_set1_epi32(every ? -1 : 0))) {}
  // Bit i for lane i.
  static MaskN from_bits(unsigned bits) {
    const __m256i bit_of_lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i set = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), bit_of_lane);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit_of_lane));
  }

  unsigned bits() const { return static_cast<unsigned>(_mm256_movemask_ps(v)); }

#ifdef __AVX512F__
  static MaskN from_mask(__mmask8 lanes) {
    return _mm256_castsi256_ps(_mm256_movm_epi32(lanes));
  }
  __mmask8 mask() const {
    return _mm256_movepi32_mask(_mm256_castps_si256(v));
  }
#endif
};

inline MaskN operator&(MaskN a, MaskN b) {
  return _mm256_and_ps(a.v, b.v);
}
inline MaskN operator|(MaskN a, MaskN b) {
  return _mm256_or_ps(a.v, b.v);
}
inline MaskN operator!(MaskN a) {
  return _mm256_xor_ps(a.v, MaskN(true).v);
}
// `a` where the mask is set, else `b`.
inline MaskN select_mask(MaskN mask, MaskN a, MaskN b) {
  return _mm256_blendv_ps(b.v, a.v, mask.v);
}
inline bool any(MaskN mask) {
  return mask.bits() != 0;
}
inline bool all(MaskN mask) {
  return mask.bits() == (1u << kLaneCount) - 1;
}

struct FloatN {
  __m256 v;

  FloatN() = default;
  FloatN(__m256 lanes) : v(lanes) {}
  FloatN(float every) : v(_mm256_set1_ps(every)) {}
  static FloatN broadcast(float x) { return {_mm256_set1_ps(x)}; }
  static FloatN load(const float* aligned) { return {_mm256_load_ps(aligned)}; }
  static FloatN load_unaligned(const float* from) { return {_mm256_loadu_ps(from)}; }
  // table[index[i]] in lane i.
  static FloatN gather(const float* table, __m256i index) { return _mm256_i32gather_ps(table, index, 4); }

  float first() const { return _mm256_cvtss_f32(v); }  // the first lane
  void store(float* aligned) const { _mm256_store_ps(aligned, v); }
  void store_unaligned(float* to) const { _mm256_storeu_ps(to, v); }
};

inline FloatN operator+(FloatN a, FloatN b) {
  return {_mm256_add_ps(a.v, b.v)};
}
inline FloatN operator-(FloatN a, FloatN b) {
  return {_mm256_sub_ps(a.v, b.v)};
}
inline FloatN operator-(FloatN a) {
  return {_mm256_xor_ps(a.v, _mm256_set1_ps(-0.0f))};
}
inline FloatN operator*(FloatN a, FloatN b) {
  return {_mm256_mul_ps(a.v, b.v)};
}
inline FloatN operator/(FloatN a, FloatN b) {
  return {_mm256_div_ps(a.v, b.v)};
}
inline MaskN operator<(FloatN a, FloatN b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ);
}
inline MaskN operator<=(FloatN a, FloatN b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ);
}
inline MaskN operator>(FloatN a, FloatN b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ);
}
inline MaskN operator>=(FloatN a, FloatN b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_GE_OQ);
}
inline MaskN operator==(FloatN a, FloatN b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ);
}
inline MaskN operator!=(FloatN a, FloatN b) {
  return _mm256_cmp_ps(a.v, b.v, _CMP_NEQ_UQ);
}
// `b` if `a` is NaN.
inline FloatN max(FloatN a, FloatN b) {
  return {_mm256_max_ps(a.v, b.v)};
}
inline FloatN min(FloatN a, FloatN b) {
  return {_mm256_min_ps(a.v, b.v)};
}
inline FloatN sqrt(FloatN a) {
  return {_mm256_sqrt_ps(a.v)};
}
inline FloatN fabs(FloatN a) {
  return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)};
}
// The larger magnitude; neither may be NaN.
inline FloatN max_magnitude(FloatN a, FloatN b) {
  return max(fabs(a), fabs(b));
}
inline FloatN floor(FloatN a) {
  return {_mm256_floor_ps(a.v)};
}
// Rounds to the nearest integer, ties to even.
inline FloatN nearbyint(FloatN a) {
  return {_mm256_round_ps(a.v, _MM_FROUND_TO_NEAREST_INT)};
}
// Whether the sign bit of each lane is set.
inline MaskN signbit(FloatN a) {
  return _mm256_castsi256_ps(_mm256_srai_epi32(_mm256_castps_si256(a.v), 31));
}
inline FloatN copysign(FloatN magnitude, FloatN sign) {
  return _mm256_or_ps(fabs(magnitude).v, _mm256_and_ps(_mm256_set1_ps(-0.0f), sign.v));
}
// a * b + c, a * b - c and c - a * b, rounded once.
inline FloatN multiply_add(FloatN a, FloatN b, FloatN c) {
  return {fused_multiply_add(a.v, b.v, c.v)};
}
inline FloatN multiply_subtract(FloatN a, FloatN b, FloatN c) {
  return {fused_multiply_subtract(a.v, b.v, c.v)};
}
inline FloatN negative_multiply_add(FloatN a, FloatN b, FloatN c) {
  return {fused_negative_multiply_add(a.v, b.v, c.v)};
}
// `a` where the mask is set, else `b`.
inline FloatN select(MaskN mask, FloatN a, FloatN b) {
  return {_mm256_blendv_ps(b.v, a.v, mask.v)};
}
// The minimum of all lanes; unspecified if any is NaN.
inline float least(FloatN a) {
  const __m128 of_four = _mm_min_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
  const __m128 of_two = _mm_min_ps(of_four, _mm_movehl_ps(of_four, of_four));
  return _mm_cvtss_f32(_mm_min_ss(of_two, _mm_movehdup_ps(of_two)));
}
inline unsigned less_equal(FloatN a, FloatN b) {
  return (a <= b).bits();
}

// Transposes kLaneCount rows of four: lane i of result d is row_at(i)[d]. Always inlined, because the results
// would otherwise pass through memory.
template <typename RowAt>
[[gnu::always_inline]] inline std::array<FloatN, 4> transposed(const RowAt& row_at) {
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

struct DoubleHalf {
  static constexpr std::size_t kLanes = kLaneCount / 2;
  __m256d v;

  DoubleHalf() = default;
  DoubleHalf(__m256d lanes) : v(lanes) {}
  DoubleHalf(double every) : v(_mm256_set1_pd(every)) {}
  // at(i), a float or a double, in lane i.
  template <typename At>
  static DoubleHalf of(const At& at) {
    if constexpr (std::is_same_v<decltype(at(0)), float>)
      return {_mm256_cvtps_pd(_mm_setr_ps(at(0), at(1), at(2), at(3)))};
    else
      return {_mm256_setr_pd(at(0), at(1), at(2), at(3))};
  }
  static DoubleHalf load(const float* aligned) { return {_mm256_cvtps_pd(_mm_load_ps(aligned))}; }
  static DoubleHalf load(const double* aligned) { return {_mm256_load_pd(aligned)}; }
  void store(double* aligned) const { _mm256_store_pd(aligned, v); }
  // Rounded to float.
  void store(float* aligned) const { _mm_store_ps(aligned, _mm256_cvtpd_ps(v)); }
};

inline DoubleHalf operator-(DoubleHalf a, DoubleHalf b) {
  return {_mm256_sub_pd(a.v, b.v)};
}
inline DoubleHalf operator-(DoubleHalf a) {
  return {_mm256_xor_pd(a.v, _mm256_set1_pd(-0.0))};
}
inline DoubleHalf operator*(DoubleHalf a, DoubleHalf b) {
  return {_mm256_mul_pd(a.v, b.v)};
}
// `b` if `a` is NaN.
inline DoubleHalf max(DoubleHalf a, DoubleHalf b) {
  return {_mm256_max_pd(a.v, b.v)};
}
inline DoubleHalf min(DoubleHalf a, DoubleHalf b) {
  return {_mm256_min_pd(a.v, b.v)};
}
inline DoubleHalf operator+(DoubleHalf a, DoubleHalf b) {
  return {_mm256_add_pd(a.v, b.v)};
}
inline DoubleHalf operator/(DoubleHalf a, DoubleHalf b) {
  return {_mm256_div_pd(a.v, b.v)};
}
inline DoubleHalf fabs(DoubleHalf a) {
  return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v)};
}
inline DoubleHalf sqrt(DoubleHalf a) {
  return {_mm256_sqrt_pd(a.v)};
}
inline DoubleHalf copysign(DoubleHalf magnitude, DoubleHalf sign) {
  return {_mm256_or_pd(fabs(magnitude).v, _mm256_and_pd(_mm256_set1_pd(-0.0), sign.v))};
}
// Rounds to the nearest integer, ties to even.
inline DoubleHalf nearbyint(DoubleHalf a) {
  return {_mm256_round_pd(a.v, _MM_FROUND_TO_NEAREST_INT)};
}
// a * b - c and c - a * b, rounded once.
inline DoubleHalf multiply_subtract(DoubleHalf a, DoubleHalf b, DoubleHalf c) {
  return {fused_multiply_subtract(a.v, b.v, c.v)};
}
inline DoubleHalf negative_multiply_add(DoubleHalf a, DoubleHalf b, DoubleHalf c) {
  return {fused_negative_multiply_add(a.v, b.v, c.v)};
}
// `a` in the lanes whose bits are set, else `b`.
inline DoubleHalf select(unsigned bits, DoubleHalf a, DoubleHalf b) {
  const __m256i bit_of_lane = _mm256_setr_epi64x(1, 2, 4, 8);
  const __m256i set = _mm256_and_si256(_mm256_set1_epi64x(bits), bit_of_lane);
  return {_mm256_blendv_pd(b.v, a.v, _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, bit_of_lane)))};
}
// As for double (core/math/lanes.hpp).
inline DoubleHalf power_of_two(DoubleHalf k) {
  const __m256d biased = _mm256_add_pd(k.v, _mm256_set1_pd(kExponentMagic));
  return {_mm256_castsi256_pd(_mm256_slli_epi64(_mm256_castpd_si256(biased), 52))};
}
inline __m256i bits_above_sqrt_half(DoubleHalf x) {
  return _mm256_sub_epi64(_mm256_castpd_si256(x.v), _mm256_castpd_si256(_mm256_set1_pd(kSqrtHalf)));
}
inline DoubleHalf exponent_near_one(DoubleHalf x) {
  const __m256i sign_flipped =
      _mm256_xor_si256(bits_above_sqrt_half(x), _mm256_castpd_si256(_mm256_set1_pd(-0.0)));
  const __m256d number =
      _mm256_or_pd(_mm256_castsi256_pd(_mm256_srli_epi64(sign_flipped, 52)), _mm256_set1_pd(0x1p52));
  return {_mm256_sub_pd(number, _mm256_set1_pd(0x1p52 + 2048))};
}
inline DoubleHalf mantissa_near_one(DoubleHalf x) {
  const __m256i exponent = _mm256_slli_epi64(_mm256_srli_epi64(bits_above_sqrt_half(x), 52), 52);
  return {_mm256_castsi256_pd(_mm256_sub_epi64(_mm256_castpd_si256(x.v), exponent))};
}
inline unsigned less(DoubleHalf a, DoubleHalf b) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)));
}

}  // namespace tessera::core
