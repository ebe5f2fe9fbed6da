// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/filter_warp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera::core::sampling {
namespace {

struct FilterCase {
  const char* name;
  float (*sample)(float u, float radius);
  double (*cdf)(double x);  // at radius 1
  double tolerance;
};

double box_cdf(double x) {
  return (x + 1) / 2;
}
double tent_cdf(double x) {
  return x < 0 ? (1 + x) * (1 + x) / 2 : 1 - (1 - x) * (1 - x) / 2;
}
double normal_cdf(double x) {
  return std::erfc(-x / std::sqrt(2.0)) / 2;
}
double truncated_normal_cdf(double x) {
  return (normal_cdf(3 * x) - normal_cdf(-3)) / (normal_cdf(3) - normal_cdf(-3));
}

class FilterWarp : public testing::TestWithParam<FilterCase> {};
INSTANTIATE_TEST_SUITE_P(All, FilterWarp,
                         testing::Values(FilterCase{"box", sample_box, box_cdf, 1e-7},
                                         FilterCase{"tent", sample_tent, tent_cdf, 2e-7},
                                         FilterCase{"gaussian", sample_truncated_normal, truncated_normal_cdf,
                                                    5e-7}),
                         [](const auto& filter) { return filter.param.name; });

constexpr int kSteps = 1 << 16;
float step(int i) {
  return static_cast<float>(i) / kSteps;
}

TEST_P(FilterWarp, InvertsTheExactDistribution) {
  for (int i = 0; i < kSteps; ++i) {
    const double x = static_cast<double>(GetParam().sample(step(i), 1));
    ASSERT_NEAR(GetParam().cdf(x), static_cast<double>(step(i)), GetParam().tolerance) << x;
  }
}

TEST_P(FilterWarp, IncreasesWithinItsRadius) {
  float before = -2.5f;
  for (int i = 0; i < kSteps; ++i) {
    const float x = GetParam().sample(step(i), 2.5f);
    ASSERT_GE(x, before) << step(i);
    before = x;
  }
  EXPECT_LE(GetParam().sample(0x1.fffffep-1f, 2.5f), 2.5f) << "the largest number below 1";
  EXPECT_GT(before, 2.4f);
}

TEST_P(FilterWarp, IsSymmetric) {
  EXPECT_EQ(GetParam().sample(0.5f, 1), 0);
  for (int i = 1; i < kSteps; ++i)
    ASSERT_NEAR(GetParam().sample(step(i), 1), -GetParam().sample(step(kSteps - i), 1), 2e-6f) << step(i);
}

TEST_P(FilterWarp, ScalesWithItsRadius) {
  for (int i = 0; i < kSteps; i += 97)
    ASSERT_FLOAT_EQ(GetParam().sample(step(i), 3), 3 * GetParam().sample(step(i), 1));
}

}  // namespace
}  // namespace tessera::core::sampling
