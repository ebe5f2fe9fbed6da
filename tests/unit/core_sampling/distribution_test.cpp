#include "core/sampling/distribution.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera::core {
namespace {

TEST(DiscreteDistribution, SamplesInProportionToWeightAndNeverWeightZero) {
  const DiscreteDistribution distribution({0, 3, 0, 1, 4, 0});
  std::vector<int> count(6);
  for (int i = 0; i < 8000; ++i) ++count[distribution.sample(i / 8000.0)];
  EXPECT_EQ(count, (std::vector<int>{0, 3000, 0, 1000, 4000, 0}));
  EXPECT_FLOAT_EQ(distribution.pmf(4), 0.5f);
  EXPECT_EQ(distribution.pmf(2), 0);
}

TEST(DiscreteDistribution, LargestNumberStaysInside) {
  const DiscreteDistribution distribution({0.1, 0.7, 0.3, 0});
  EXPECT_EQ(distribution.sample(std::nextafter(1.0, 0.0)), 2u);
}

TEST(DiscreteDistribution, CanBeEmpty) {
  EXPECT_TRUE(DiscreteDistribution(std::vector<double>{}).empty());
}

}  // namespace
}  // namespace tessera::core
