// SPDX-License-Identifier: Apache-2.0
// Table lookups for vectors that load whole rows, one lane at a time, which is much faster than gathering
// single numbers.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/math/lane_array.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core {

// Loads two, three or four numbers, padded with zeros; reads nothing beyond them.
template <std::size_t kCount>
__m128 load_row(const float* from) {
  static_assert(kCount >= 2 && kCount <= 4);
  if constexpr (kCount == 4) return _mm_loadu_ps(from);
  if constexpr (kCount == 3) return _mm_maskload_ps(from, _mm_setr_epi32(-1, -1, -1, 0));
  return _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from)));
}

// table[index], table[index + 1] and so on, for each lane.
template <std::size_t kCount>
std::array<float, kCount> look_up_row(const float* table, std::uint32_t index) {
  std::array<float, kCount> row;
  for (std::uint32_t i = 0; i < kCount; ++i) row[i] = table[index + i];
  return row;
}
// The numbers at row_at(lane), for each lane.
template <std::size_t kCount, typename RowAt>
std::array<FloatN, kCount> load_rows(const RowAt& row_at) {
  const auto pair = [&](std::size_t lane) {  // the rows of lanes `lane` and `lane` + 4
    return _mm256_set_m128(load_row<kCount>(row_at(lane + 4)), load_row<kCount>(row_at(lane)));
  };
  const __m256 a = pair(0), b = pair(1), c = pair(2), d = pair(3);
  const __m256 ab_low = _mm256_unpacklo_ps(a, b), cd_low = _mm256_unpacklo_ps(c, d);
  const __m256 ab_high = _mm256_unpackhi_ps(a, b), cd_high = _mm256_unpackhi_ps(c, d);
  std::array<FloatN, kCount> columns;
  columns[0] = _mm256_shuffle_ps(ab_low, cd_low, 0x44);
  columns[1] = _mm256_shuffle_ps(ab_low, cd_low, 0xee);
  if constexpr (kCount > 2) columns[2] = _mm256_shuffle_ps(ab_high, cd_high, 0x44);
  if constexpr (kCount > 3) columns[3] = _mm256_shuffle_ps(ab_high, cd_high, 0xee);
  return columns;
}
template <std::size_t kCount>
std::array<FloatN, kCount> look_up_row(const float* table, U32xN index) {
  const WordLanes of_lane(index);
  return load_rows<kCount>([&](std::size_t lane) { return table + of_lane[lane]; });
}
template <std::size_t kCount>
std::array<U32xN, kCount> look_up_row(const std::uint32_t* table, U32xN index) {
  const auto columns = look_up_row<kCount>(reinterpret_cast<const float*>(table), index);
  std::array<U32xN, kCount> words;
  for (std::size_t i = 0; i < kCount; ++i) words[i] = as_bits(columns[i]);
  return words;
}

// Sixteen numbers in a register.
using SixteenShorts = std::array<std::int16_t, 16>;

// The number of entries, of sixteen in ascending order, that are at most `key`.
inline std::uint32_t count_up_to(std::int16_t key, const std::int16_t* numbers) {
  const __m256i all = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(numbers));
  const __m256i above = _mm256_cmpgt_epi16(all, _mm256_set1_epi16(key));
  // The mask has two bits for each entry.
  return static_cast<std::uint32_t>(std::countr_zero(static_cast<unsigned>(_mm256_movemask_epi8(above)))) / 2;
}
inline std::uint32_t count_up_to(std::int16_t key, const SixteenShorts& numbers) {
  return count_up_to(key, numbers.data());
}

// Unpacks two-bit numbers, the first in the lowest bits: lane i gets number i in its lowest bits.
inline U32xN unpack_pairs_of_bits(std::uint32_t packed) {
  return _mm256_srlv_epi32(U32xN(packed).v, _mm256_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14));
}

// A point from which each lane reads one coordinate.
class CoordinateLanes {
 public:
  explicit CoordinateLanes(Vec3 p) : twice_(_mm256_setr_ps(p.x, p.y, p.z, 0, p.x, p.y, p.z, 0)) {}
  // The two lowest bits of each lane select the axis.
  FloatN along(U32xN axis) const { return _mm256_permutevar_ps(twice_.v, axis.v); }

 private:
  FloatN twice_;
};

}  // namespace tessera::core
