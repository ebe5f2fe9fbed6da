// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/distribution.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/sampling/bilinear_distribution.hpp"

namespace tessera::core::sampling {
namespace {

TEST(DiscreteDistribution, SamplesInProportionToWeightAndNeverWeightZero) {
  const DiscreteDistribution distribution({0, 3, 0, 1, 4, 0});
  std::vector<int> count(6);
  for (int i = 0; i < 8000; ++i) ++count[distribution.sample(i / 8000.0)];
  EXPECT_EQ(count, (std::vector<int>{0, 3000, 0, 1000, 4000, 0}));
  EXPECT_FLOAT_EQ(distribution.pmf(4), 0.5f);
  EXPECT_EQ(distribution.pmf(2), 0);
}

TEST(DiscreteDistribution, LeavesARestThatIsUniform) {
  const DiscreteDistribution distribution({0, 3, 0, 1, 4});
  const auto expect = [&](double u, std::size_t index, double rest) {
    const auto sample = distribution.sample_and_rest(u);
    EXPECT_EQ(sample.index, index) << u;
    EXPECT_NEAR(sample.rest, rest, 1e-12) << u;
  };
  expect(0, 1, 0);
  expect(0.25, 1, 2.0 / 3);
  expect(0.4375, 3, 0.5);
  expect(0.5, 4, 0);
  EXPECT_LT(distribution.sample_and_rest(1 - 0x1p-53).rest, 1);
  EXPECT_EQ(DiscreteDistribution({7}).sample_and_rest(0.3).rest, 0.3);
}

TEST(DiscreteDistribution, LargestNumberStaysInside) {
  const DiscreteDistribution distribution({0.1, 0.7, 0.3, 0});
  EXPECT_EQ(distribution.sample(std::nextafter(1.0, 0.0)), 2u);
}

TEST(DiscreteDistribution, CanBeEmpty) {
  EXPECT_TRUE(DiscreteDistribution(std::vector<double>{}).empty());
}

TEST(GridDistribution, ChoosesCellsInProportionAndEvenlyWithinThem) {
  const std::vector<double> weights{0, 1, 3, 0, 0, 0, 4, 0, 8};
  const GridDistribution grid(3, 3, weights);
  constexpr int kGridSide = 400;
  std::vector<double> counts(9), x(9), y(9);
  for (int i = 0; i < kGridSide; ++i)
    for (int j = 0; j < kGridSide; ++j) {
      const auto choice = grid.sample({(i + 0.5) / kGridSide, (j + 0.5) / kGridSide});
      const auto cell = static_cast<std::size_t>(choice.y * 3 + choice.x);
      ASSERT_GT(weights[cell], 0);
      ASSERT_GE(std::min(choice.within.x, choice.within.y), 0);
      ASSERT_LT(std::max(choice.within.x, choice.within.y), 1);
      counts[cell] += 1.0 / (kGridSide * kGridSide);
      x[cell] += static_cast<double>(choice.within.x) / (kGridSide * kGridSide);
      y[cell] += static_cast<double>(choice.within.y) / (kGridSide * kGridSide);
    }
  for (std::size_t cell = 0; cell < 9; ++cell) {
    EXPECT_NEAR(grid.pmf(static_cast<int>(cell % 3), static_cast<int>(cell / 3)), weights[cell] / 16, 2e-9);
    EXPECT_NEAR(counts[cell], weights[cell] / 16, 0.005);
    EXPECT_NEAR(x[cell], counts[cell] / 2, 0.002);
    EXPECT_NEAR(y[cell], counts[cell] / 2, 0.002);
  }
}

TEST(GridDistribution, ReachesBothEndsOfItsRange) {
  const GridDistribution grid(2, 2, {1, 0, 0, 1e-3});
  const auto first = grid.sample({0, 0}), last = grid.sample({1 - 0x1p-53, 1 - 0x1p-53});
  EXPECT_EQ(first.x + 2 * first.y, 0);
  EXPECT_EQ(last.x + 2 * last.y, 3);
  EXPECT_LT(last.within.x, 1);
}

// Wherever it falls, a number finds the cell that a search of all of them does, however uneven they are.
TEST(GridDistribution, FindsTheCellThatTheNumberFallsOn) {
  constexpr int kWidth = 203;
  std::vector<double> weights(kWidth);
  for (int x = 0; x < kWidth; ++x)
    weights[static_cast<std::size_t>(x)] = x % 7 == 3 ? 0 : std::pow(1.1, x % 90);
  weights[100] = 1e-30;
  const GridDistribution grid(kWidth, 1, weights);
  double total = 0;
  for (int x = 0; x < kWidth; ++x) total += grid.pmf(x, 0);
  EXPECT_EQ(total, 1);
  EXPECT_GT(grid.pmf(100, 0), 0);
  int cell = 0;
  double end = grid.pmf(0, 0);
  for (int i = 0; i < 1 << 20; ++i) {
    while (end <= i * 0x1p-20) end += grid.pmf(++cell, 0);
    const auto choice = grid.sample({i * 0x1p-20, 0.5});
    ASSERT_EQ(choice.x, cell) << i;
    ASSERT_NEAR(choice.within.x, (i * 0x1p-20 - end) / grid.pmf(cell, 0) + 1, 1e-6);
  }
}

// Between the middles of four cells the density is the mean of theirs, and what is sampled is what it says.
TEST(BilinearDistribution, IsInterpolatedBetweenMiddlesAndSampledSo) {
  const std::vector<double> weights{0, 1, 3, 0, 0, 8, 4, 0, 0, 0, 2, 6};
  const BilinearDistribution grid(4, 3, weights);
  EXPECT_FLOAT_EQ(grid.density({1.5f, 0.5f}), 1 / 24.0f);
  EXPECT_FLOAT_EQ(grid.density({2.0f, 1.0f}), (1 + 3 + 8 + 4) / 4 / 24.0f);
  EXPECT_FLOAT_EQ(grid.density({3.9f, 2.9f}), 6 / 24.0f) << "even beyond the outermost middles";
  EXPECT_FLOAT_EQ(grid.density({0.25f, 2.0f}), 0);

  constexpr int kGridSide = 600, kPerCell = 4;
  std::vector<double> observed(4 * 3 * kPerCell * kPerCell), expected(observed.size());
  const auto part = [](Vec2 place) {
    const int x = std::min(static_cast<int>(place.x * kPerCell), 4 * kPerCell - 1),
              y = std::min(static_cast<int>(place.y * kPerCell), 3 * kPerCell - 1);
    return static_cast<std::size_t>(y * 4 * kPerCell + x);
  };
  for (int i = 0; i < kGridSide; ++i)
    for (int j = 0; j < kGridSide; ++j) {
      const auto [place, density] = grid.sample({(i + 0.5) / kGridSide, (j + 0.5) / kGridSide});
      ASSERT_GT(density, 0);
      observed[part(place)] += 1.0 / (kGridSide * kGridSide);
    }
  double total = 0;
  for (int y = 0; y < 3 * kPerCell; ++y)
    for (int x = 0; x < 4 * kPerCell; ++x) {
      const Vec2 middle{(static_cast<float>(x) + 0.5f) / kPerCell, (static_cast<float>(y) + 0.5f) / kPerCell};
      const double density = static_cast<double>(grid.density(middle)) / (kPerCell * kPerCell);
      EXPECT_NEAR(observed[part(middle)], density, 5e-4) << x << ", " << y;
      total += density;
    }
  EXPECT_NEAR(total, 1, 1e-6);
}

TEST(BilinearDistribution, HasADensityAtBothEndsOfItsRange) {
  for (const std::vector<double>& weights : {std::vector<double>{0, 1, 0}, {1, 0, 0}, {0, 0, 2}, {1, 5, 2}}) {
    const BilinearDistribution grid(3, 1, weights);
    for (const double u : {0.0, 1 - 0x1p-53}) {
      const auto [place, density] = grid.sample({u, u});
      EXPECT_GE(std::min(place.x, place.y), 0);
      EXPECT_LE(place.x, 3);
      EXPECT_LE(place.y, 1);
      EXPECT_GT(density, 0);
    }
  }
}

TEST(BilinearDistribution, HasSomeDensityEverywhere) {
  const BilinearDistribution grid(2, 1, {1, 3});
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_FLOAT_EQ(grid.density({-1, 0}), 0.25f);
  EXPECT_FLOAT_EQ(grid.density({kInfinity, 7}), 0.75f);
  EXPECT_FLOAT_EQ(grid.density({kNan, kNan}), 0.25f);
}

}  // namespace
}  // namespace tessera::core::sampling
