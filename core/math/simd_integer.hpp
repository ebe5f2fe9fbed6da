// SPDX-License-Identifier: Apache-2.0
// Vectors of unsigned integers, of 32 and of 64 bits, with the arithmetic of the scalar types.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/simd.hpp"

namespace tessera::core {

struct U32xN {
  __m256i v;

  U32xN() = default;
  U32xN(__m256i lanes) : v(lanes) {}
  U32xN(std::uint32_t every) : v(_mm256_set1_epi32(static_cast<int>(every))) {}
  static U32xN load(const std::uint32_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  }

  // Each lane from a narrower number.
  static U32xN load_bytes(const std::uint8_t* from) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from)));
  }
  static U32xN load_shorts(const std::uint16_t* from) {
    return _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
  }

  void store(std::uint32_t* to) const { _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), v); }
};

inline U32xN operator+(U32xN a, U32xN b) {
  return _mm256_add_epi32(a.v, b.v);
}
inline U32xN operator-(U32xN a, U32xN b) {
  return _mm256_sub_epi32(a.v, b.v);
}
inline U32xN operator*(U32xN a, U32xN b) {
  return _mm256_mullo_epi32(a.v, b.v);
}
inline U32xN operator&(U32xN a, U32xN b) {
  return _mm256_and_si256(a.v, b.v);
}
inline U32xN operator|(U32xN a, U32xN b) {
  return _mm256_or_si256(a.v, b.v);
}
inline U32xN operator^(U32xN a, U32xN b) {
  return _mm256_xor_si256(a.v, b.v);
}
inline U32xN operator<<(U32xN a, int count) {
  return _mm256_slli_epi32(a.v, count);
}
inline U32xN operator>>(U32xN a, int count) {
  return _mm256_srli_epi32(a.v, count);
}
inline MaskN operator==(U32xN a, U32xN b) {
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a.v, b.v));
}
inline MaskN operator!=(U32xN a, U32xN b) {
  return !(a == b);
}
inline U32xN select(MaskN mask, U32xN a, U32xN b) {
  return _mm256_blendv_epi8(b.v, a.v, _mm256_castps_si256(mask.v));
}

// Bit i is the highest bit of lane i.
inline unsigned highest_bits(U32xN a) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(a.v)));
}

inline U32xN as_bits(FloatN a) {
  return _mm256_castps_si256(a.v);
}
inline FloatN as_float(U32xN a) {
  return _mm256_castsi256_ps(a.v);
}
// Requires numbers below 2^31.
inline FloatN to_float(U32xN a) {
  return _mm256_cvtepi32_ps(a.v);
}

// Broadcasts lane `lane` of `a`.
inline U32xN in_every_lane(U32xN a, int lane) {
  return _mm256_permutevar8x32_epi32(a.v, _mm256_set1_epi32(lane));
}
// Lane order[i] of `a` in lane i.
inline FloatN permuted(FloatN a, U32xN order) {
  return _mm256_permutevar8x32_ps(a.v, order.v);
}
// Rounds towards 0. The result is at least 2^31 for NaN, for values of at most -1, and for values that do
// not fit.
inline U32xN truncated(FloatN a) {
  return _mm256_cvttps_epi32(a.v);
}
inline U32xN min(U32xN a, U32xN b) {
  return _mm256_min_epu32(a.v, b.v);
}
// Requires numbers below 2^31.
inline MaskN less_if_small(U32xN a, U32xN b) {
  return _mm256_castsi256_ps(_mm256_cmpgt_epi32(b.v, a.v));
}

// Reverses the order of the bits of each lane.
inline U32xN reverse_bits(U32xN a) {
  const __m256i nibble = _mm256_set1_epi8(15);
  const __m256i reversed =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m256i bytes_reversed =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const __m256i low = _mm256_shuffle_epi8(reversed, _mm256_and_si256(a.v, nibble));
  const __m256i high = _mm256_shuffle_epi8(reversed, _mm256_and_si256(_mm256_srli_epi32(a.v, 4), nibble));
  return _mm256_shuffle_epi8(_mm256_or_si256(_mm256_slli_epi32(low, 4), high), bytes_reversed);
}

// Transposes: lane i of result d is rows[i][d].
inline std::array<U32xN, 4> transpose(const std::array<std::array<std::uint32_t, 4>, kLaneCount>& rows) {
  const auto [a, b, c, d] =
      transposed([&rows](std::size_t i) { return reinterpret_cast<const float*>(rows[i].data()); });
  return {as_bits(a), as_bits(b), as_bits(c), as_bits(d)};
}

struct U64xN {
  __m256i even, odd;  // lanes 0, 1, 4, 5 and lanes 2, 3, 6, 7, so that they interleave with 32-bit lanes

  U64xN() = default;
  U64xN(__m256i even_lanes, __m256i odd_lanes) : even(even_lanes), odd(odd_lanes) {}
  U64xN(std::uint64_t every) : even(_mm256_set1_epi64x(static_cast<long long>(every))), odd(even) {}
  static U64xN of(const std::array<std::uint64_t, kLaneCount>& a) {
    const auto number = [&a](std::size_t i) { return static_cast<long long>(a[i]); };
    return {_mm256_setr_epi64x(number(0), number(1), number(4), number(5)),
            _mm256_setr_epi64x(number(2), number(3), number(6), number(7))};
  }
};

template <int kWhich>
U32xN words(U64xN a) {
  return _mm256_castps_si256(
      _mm256_shuffle_ps(_mm256_castsi256_ps(a.even), _mm256_castsi256_ps(a.odd), kWhich));
}
inline U32xN low_word(U64xN a) {
  return words<_MM_SHUFFLE(2, 0, 2, 0)>(a);
}
inline U32xN high_word(U64xN a) {
  return words<_MM_SHUFFLE(3, 1, 3, 1)>(a);
}

inline U64xN operator+(U64xN a, U64xN b) {
  return {_mm256_add_epi64(a.even, b.even), _mm256_add_epi64(a.odd, b.odd)};
}
inline U64xN operator^(U64xN a, U64xN b) {
  return {_mm256_xor_si256(a.even, b.even), _mm256_xor_si256(a.odd, b.odd)};
}
inline U64xN operator>>(U64xN a, int count) {
  return {_mm256_srli_epi64(a.even, count), _mm256_srli_epi64(a.odd, count)};
}
// The product modulo 2^64, from 32-bit products.
inline __m256i multiply(__m256i a, __m256i b) {
  const __m256i a_high = _mm256_srli_epi64(a, 32), b_high = _mm256_srli_epi64(b, 32);
  const __m256i crossed = _mm256_add_epi64(_mm256_mul_epu32(a_high, b), _mm256_mul_epu32(a, b_high));
  return _mm256_add_epi64(_mm256_mul_epu32(a, b), _mm256_slli_epi64(crossed, 32));
}
inline U64xN operator*(U64xN a, U64xN b) {
  return {multiply(a.even, b.even), multiply(a.odd, b.odd)};
}

}  // namespace tessera::core
