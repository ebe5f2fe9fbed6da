// SPDX-License-Identifier: Apache-2.0
#include "core/film/sum_buffer.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/film/fixed_point.hpp"

namespace tessera::core {
namespace {

constexpr std::uint64_t kLargestNarrow = 0xffff'ffff;

TEST(SumBuffer, IsNothingButZerosAtFirst) {
  SumBuffer sums(5);
  sums.add(0, std::vector<std::uint64_t>(5));
  sums.add(3, {});
  EXPECT_EQ(sums.size(), 5u);
  EXPECT_EQ(sums.memory_bytes(), 0u);
  EXPECT_EQ(sums.values(), std::vector<std::uint64_t>(5));
}

// Whatever is added in whatever order, at every edge of the two widths.
TEST(SumBuffer, AddsAsSixtyFourBitsDo) {
  const std::vector<std::uint64_t> values{0,
                                          1,
                                          kLargestNarrow - 1,
                                          kLargestNarrow,
                                          kLargestNarrow + 1,
                                          std::uint64_t{1} << 63,
                                          kFilmSaturated - 1,
                                          kFilmSaturated};
  std::mt19937 random(1);
  for (int run = 0; run < 2000; ++run) {
    SumBuffer sums(7);
    std::vector<std::uint64_t> expected(7);
    for (int step = 0; step < 6; ++step) {
      const std::size_t begin = random() % 7;
      std::vector<std::uint64_t> terms(random() % (8 - begin));
      for (std::size_t i = 0; i < terms.size(); ++i) {
        terms[i] = values[random() % (run % 2 == 0 ? 3 : values.size())];
        expected[begin + i] = add_saturating(expected[begin + i], terms[i]);
      }
      sums.add(begin, terms);
      ASSERT_EQ(sums.values(), expected) << run << ' ' << step;
    }
    // Kept as the sums ask for, not as they came about.
    SumBuffer at_once(7);
    at_once.add(0, expected);
    ASSERT_TRUE(at_once == sums) << run;
    ASSERT_EQ(at_once.memory_bytes(), sums.memory_bytes()) << run;
  }
}

TEST(SumBuffer, TakesEightBytesForEachFromTwoToTheThirtyTwoOn) {
  SumBuffer sums(10);
  sums.add(9, std::vector<std::uint64_t>{kLargestNarrow});
  EXPECT_EQ(sums.memory_bytes(), 40u);
  sums.add(9, std::vector<std::uint64_t>{1});
  EXPECT_EQ(sums.memory_bytes(), 80u);
}

}  // namespace
}  // namespace tessera::core
