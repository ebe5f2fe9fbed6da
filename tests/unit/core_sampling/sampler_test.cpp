// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/sampler.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "core/sampling/sobol.hpp"

namespace tessera::core::sampling {
namespace {

TEST(Sobol, StartsAsPublished) {
  // Joe and Kuo's dimensions 1 to 3, points 0 to 4, in units of 1/8.
  const std::uint32_t expected[5][3] = {{0, 0, 0}, {4, 4, 4}, {2, 6, 6}, {6, 2, 2}, {1, 5, 3}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    const auto point = sobol_reversed(i);
    for (std::size_t d = 0; d < 3; ++d)
      EXPECT_EQ(reverse_bits(point[d]) >> 29, expected[i][d]) << i << " " << d;
  }
}

// Counts how many of the first n samples fall into each cell of a grid over two dimensions of a pad.
std::vector<int> cells(std::uint32_t n, std::size_t dim_a, int columns, std::size_t dim_b, int rows,
                       std::uint32_t pad) {
  std::vector<int> count(static_cast<std::size_t>(columns * rows));
  for (std::uint32_t s = 0; s < n; ++s) {
    const auto u = Sampler(99, 12, 34, s).pad(pad);
    const auto a = static_cast<int>(u[dim_a] * static_cast<float>(columns));
    const auto b = static_cast<int>(u[dim_b] * static_cast<float>(rows));
    ++count[static_cast<std::size_t>(b * columns + a)];
  }
  return count;
}

TEST(Sampler, FirstSamplesStratifyEveryElementaryRectangle) {
  for (std::uint32_t pad = 0; pad < 5; ++pad)
    for (const auto& [columns, rows] :
         {std::pair{1, 64}, {2, 32}, {4, 16}, {8, 8}, {16, 4}, {32, 2}, {64, 1}})
      for (const int count : cells(64, 0, columns, 1, rows, pad))
        ASSERT_EQ(count, 1) << pad << " " << columns;
}

TEST(Sampler, EveryDimensionIsStratified) {
  for (std::uint32_t pad = 0; pad < 5; ++pad)
    for (std::size_t d = 0; d < 4; ++d)
      for (const int count : cells(256, d, 256, d, 1, pad)) ASSERT_EQ(count, 1);
}

TEST(Sampler, IsAFunctionOfItsArgumentsAlone) {
  const auto once = Sampler(1, 2, 3, 4).pad(5);
  Sampler(9, 9, 9, 9).pad(9);
  EXPECT_EQ(Sampler(1, 2, 3, 4).pad(5), once);
}

TEST(Sampler, EveryArgumentMatters) {
  const std::set<std::array<float, 4>> distinct{Sampler(1, 2, 3, 4).pad(5), Sampler(0, 2, 3, 4).pad(5),
                                                Sampler(1, 3, 3, 4).pad(5), Sampler(1, 2, 2, 4).pad(5),
                                                Sampler(1, 2, 3, 5).pad(5), Sampler(1, 2, 3, 4).pad(6),
                                                Sampler(1, 3, 2, 4).pad(5)};
  EXPECT_EQ(distinct.size(), 7u);
}

TEST(Sampler, StaysInTheUnitCubeAndIsUniform) {
  double sum = 0;
  for (int x = 0; x < 500; ++x)
    for (std::uint32_t s = 0; s < 8; ++s)
      for (const float u : Sampler(3, x, 7, s).pad(2)) {
        ASSERT_GE(u, 0);
        ASSERT_LT(u, 1);
        sum += static_cast<double>(u);
      }
  EXPECT_NEAR(sum / (500 * 8 * 4), 0.5, 0.005);
}

// Pads and pixels are decorrelated: the sample correlation of any two stays within five standard errors.
TEST(Sampler, PadsAndPixelsAreUncorrelated) {
  constexpr std::uint32_t kSamples = 4096;
  const auto correlation = [](auto first, auto second) {
    double sum = 0;
    for (std::uint32_t s = 0; s < kSamples; ++s) sum += (first(s) - 0.5) * (second(s) - 0.5);
    return sum / kSamples * 12;
  };
  for (std::uint32_t pad = 1; pad < 12; ++pad) {
    const auto a = [](std::uint32_t s) { return static_cast<double>(Sampler(0, 1, 1, s).pad(0)[0]); };
    const auto b = [pad](std::uint32_t s) { return static_cast<double>(Sampler(0, 1, 1, s).pad(pad)[0]); };
    const auto c = [pad](std::uint32_t s) {
      return static_cast<double>(Sampler(0, 1 + static_cast<int>(pad), 1, s).pad(0)[0]);
    };
    EXPECT_NEAR(correlation(a, b), 0, 5 / 64.0) << pad;
    EXPECT_NEAR(correlation(a, c), 0, 5 / 64.0) << pad;
  }
}

TEST(Sampler, DitherIsUniformAndDiffersByChannel) {
  std::array<double, 3> mean{};
  for (std::uint32_t s = 0; s < 10000; ++s) {
    const auto u = Sampler(0, 5, 5, s).film_dither();
    for (std::size_t c = 0; c < 3; ++c) mean[c] += u[c] / 10000;
    ASSERT_NE(u[0], u[1]);
  }
  for (const double m : mean) EXPECT_NEAR(m, 0.5, 0.015);
}

TEST(Sampler, EightAtOnceAreWhatEachIsAlone) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    std::vector<Sampler> samplers;
    std::array<const Sampler*, 8> pointers;
    for (std::uint32_t lane = 0; lane < 8; ++lane)
      samplers.emplace_back(i / 7, static_cast<int>(i * lane), static_cast<int>(i % 5), i * i * lane + i);
    for (std::size_t lane = 0; lane < 8; ++lane) pointers[lane] = &samplers[lane];
    const auto pads = Sampler::pads(pointers, i % 50);
    for (std::size_t d = 0; d < 4; ++d) {
      alignas(32) float lanes[8];
      pads[d].store(lanes);
      for (std::size_t lane = 0; lane < 8; ++lane) ASSERT_EQ(lanes[lane], samplers[lane].pad(i % 50)[d]);
    }
  }
}

}  // namespace
}  // namespace tessera::core::sampling
