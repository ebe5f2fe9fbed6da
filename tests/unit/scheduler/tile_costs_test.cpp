// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/tile_costs.hpp"

#include <gtest/gtest.h>

#include "server/scheduler/job.hpp"

namespace tessera::scheduler {
namespace {

constexpr double kSamples = 64 * 64;

TEST(TileCosts, AreEqualWhileNothingIsKnown) {
  const TileCosts costs(4);
  EXPECT_EQ(costs.relative(3), 1);
}

// In results of both tiles, and in those of one.
TEST(TileCosts, ComeToWhatIsMeasured) {
  TileCosts costs(4);
  // A worker renders a thousand samples of the mean cost, which is the root of 2 * 8, in a second.
  const auto seconds = [](double first, double second) { return (2 * first + 8 * second) / 4'000; };
  for (int i = 0; i < 30; ++i) {
    costs.learn({{0, kSamples}}, 1'000 * seconds(kSamples, 0));
    costs.learn({{1, kSamples}}, 1'000 * seconds(0, kSamples));
    costs.learn({{0, kSamples}, {1, kSamples}}, 1'000 * seconds(kSamples, kSamples));
  }
  EXPECT_NEAR(costs.relative(1) / costs.relative(0), 4, 0.01);
  EXPECT_NEAR(costs.relative(0) * costs.relative(1), 1, 1e-5);
  EXPECT_EQ(costs.relative(2), 1);
}

TEST(TileCosts, OfOthersHardlyChangeByAWrongOne) {
  TileCosts costs(100);
  for (int tile = 0; tile < 100; ++tile) costs.learn({{tile, kSamples}}, kSamples);
  for (const double claimed : {1e308, 5e-324, 1e308, 1e308}) {
    costs.learn({{99, kSamples}}, claimed);
    EXPECT_NEAR(costs.relative(0), 1, 0.1) << claimed;
    EXPECT_TRUE(costs.relative(99) >= 1.0 / 64 && costs.relative(99) <= 64) << claimed;
  }
  for (int i = 0; i < 100; ++i) costs.learn({{99, kSamples}}, kSamples);
  EXPECT_NEAR(costs.relative(99), 1, 0.01);
}

TEST(TileCosts, ChangeOnceWithAResultOfSeveralParts) {
  TileCosts costs(3);
  for (int tile = 0; tile < 3; ++tile) costs.learn({{tile, kSamples}}, kSamples);
  costs.learn({{0, kSamples}, {0, kSamples}, {0, kSamples}, {0, kSamples}}, 16 * kSamples);
  EXPECT_NEAR(costs.relative(0), 1.5874, 1e-3);  // 2 beside the cube root of 2
}

class LeasesOfTilesTest : public ::testing::Test {
 protected:
  // The first tile costs four times as much as the second. Both have the first sample.
  LeasesOfTilesTest() {
    std::vector<Lease> ended;
    for (int tile = 0; tile < 2; ++tile) {
      job_.lease({{static_cast<std::uint64_t>(tile) + 1}, {"worker"}, {{tile, {0, 1}}}, false});
      job_.accept({tile, {0, 1}}, ended);
      job_.learn_costs({{tile, {0, 1}}}, kSamples);
    }
    for (int i = 0; i < 30; ++i) {
      job_.learn_costs({{0, {0, 1}}}, 2 * kSamples);
      job_.learn_costs({{1, {0, 1}}}, 0.5 * kSamples);
    }
  }

  Job job_{1, {"job"}, {128, 64, 1024}, {}, JobState::kRunning, {}};
};

TEST_F(LeasesOfTilesTest, OfCostlyTilesHaveFewerSamples) {
  const double work = 160 * kSamples;  // of mean samples: [1, 2), [2, 4) … of both tiles come first
  const Portion portion = job_.next_free({work, 1e9}, true);
  double mean_samples = 0;
  for (const WorkItem& item : portion.items) mean_samples += job_.mean_samples(item);
  EXPECT_NEAR(mean_samples, work, 3 * kSamples);
  EXPECT_NEAR(job_.mean_samples({0, {4, 5}}) / job_.mean_samples({1, {4, 5}}), 4, 1e-3);
}

TEST_F(LeasesOfTilesTest, OfCheapTilesAreLimitedByTheirSamples) {
  const Portion portion = job_.next_free({160 * kSamples, 10 * kSamples}, true);
  std::uint64_t samples = 0;
  for (const WorkItem& item : portion.items) samples += job_.pixel_samples(item);
  EXPECT_EQ(samples, 10 * 64 * 64u);
}

}  // namespace
}  // namespace tessera::scheduler
