// SPDX-License-Identifier: Apache-2.0
#include "core/math/table_interpolation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <limits>

#include "core/math/lane_array.hpp"

namespace tessera::core {
namespace {

// Two tables of 3 x 4 numbers.
constexpr std::array<float, 24> kTables{0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23,
                                        5, 5, 5, 5, 5,  5,  5,  5,  9,  9,  9,  9};

float table_at(float row, float column, std::uint32_t first = 0) {
  return interpolated<3, 4>(kTables.data(), row, column, first);
}

TEST(TableInterpolation, GivesTheNodes) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      EXPECT_FLOAT_EQ(table_at(static_cast<float>(row) / 2, static_cast<float>(column) / 3),
                      static_cast<float>(10 * row + column));
}

TEST(TableInterpolation, IsLinearBetweenThem) {
  EXPECT_FLOAT_EQ(table_at(0.25f, 0.5f), 6.5f);
  EXPECT_FLOAT_EQ(table_at(0.75f, 0.25f, 12), 7) << "of the second table";
}

TEST(TableInterpolation, StaysWithinTheTable) {
  EXPECT_FLOAT_EQ(table_at(-3, -1), 0);
  EXPECT_FLOAT_EQ(table_at(2, 1e30f), 23);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  table_at(nan, nan);  // reads no other memory
}

TEST(TableInterpolation, OfLanesIsThatOfEach) {
  FloatLanes rows, columns;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    rows.set(lane, 0.13f * static_cast<float>(lane));
    columns.set(lane, 1.1f - 0.17f * static_cast<float>(lane));
  }
  const FloatLanes all(interpolated<3, 4>(kTables.data(), rows.all(), columns.all()));
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    EXPECT_EQ(all[lane], table_at(rows[lane], columns[lane]));
}

}  // namespace
}  // namespace tessera::core
