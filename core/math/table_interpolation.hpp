// SPDX-License-Identifier: Apache-2.0
// Bilinear interpolation in tables of numbers. T is float for one point, or FloatN for one in each lane.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/math/simd.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core {

// A place between two nodes of a table's axis.
template <typename T>
struct TablePlace {
  // `place` runs from 0 to 1 over all nodes; others are clamped.
  TablePlace(T place, std::uint32_t nodes) {
    const T scaled = clamp_between(place, 0.0f, 1.0f) * static_cast<float>(nodes - 1);
    low = smaller_word(to_word(scaled), WordOf<T>(nodes - 2));  // also of NaN
    share = scaled - to_float(low);
  }

  T mix(T at_low, T at_high) const { return at_low + share * (at_high - at_low); }

  WordOf<T> low;
  T share;
};

// Between the four nodes around a place in a table of kRows x kColumns numbers, which begins at table[first].
template <std::uint32_t kRows, std::uint32_t kColumns, typename T>
T interpolated(const float* table, T row_place, T column_place,
               std::type_identity_t<WordOf<T>> first = WordOf<T>(0)) {
  const TablePlace<T> row(row_place, kRows), column(column_place, kColumns);
  const WordOf<T> corner = first + row.low * WordOf<T>(kColumns) + column.low;
  const auto along_row = [&](WordOf<T> at) {
    return column.mix(look_up(table, at), look_up(table, at + WordOf<T>(1)));
  };
  return row.mix(along_row(corner), along_row(corner + WordOf<T>(kColumns)));
}

}  // namespace tessera::core
