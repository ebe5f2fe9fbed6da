// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/policy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace tessera::scheduler {
namespace {

constexpr std::uint64_t kPlenty = 1'000'000'000'000;
const SizingOptions kOptions;

TEST(NextLeaseSize, KeepsAMeasuredWorkerBusyForTwoSeconds) {
  EXPECT_EQ(next_lease_size(kOptions, {8, 300'000.0}, kPlenty, 10).mean_samples, 600'000);
}

TEST(NextLeaseSize, IsSmallWhileTheSpeedIsUnknown) {
  EXPECT_EQ(next_lease_size(kOptions, {8, std::nullopt}, kPlenty, 10).mean_samples,
            100'000);  // 8 * 50,000/s * 0.25 s
}

TEST(NextLeaseSize, ShrinksTowardsTheEnd) {
  EXPECT_EQ(next_lease_size(kOptions, {8, 300'000.0}, 1'000'000, 10).mean_samples, 50'000);  // a 20th of it
}

// What is known of tiles makes leases of costly ones shorter, and none longer.
TEST(NextLeaseSize, IsLimitedInSamplesOfEitherKind) {
  const LeaseSize size = next_lease_size(kOptions, {8, 300'000.0, 500'000.0}, kPlenty, 10);
  EXPECT_EQ(size.mean_samples, 1'000'000);
  EXPECT_EQ(size.most_samples, 600'000);
  const LeaseSize at_end = next_lease_size(kOptions, {8, 300'000.0, 500'000.0}, 1'000'000, 10);
  EXPECT_EQ(at_end.mean_samples, 50'000);
  EXPECT_EQ(at_end.most_samples, 50'000);
}

TEST(NextLeaseSize, IsNeverShorterThanWorthTheJourney) {
  EXPECT_EQ(next_lease_size(kOptions, {8, 300'000.0}, 100'000, 10).mean_samples, 30'000);  // 0.1 s
}

TEST(NextLeaseSize, IsNeverMoreThanThereIs) {
  EXPECT_EQ(next_lease_size(kOptions, {8, 300'000.0}, 5'000, 1).mean_samples, 5'000);
}

TEST(NextLeaseSize, IsAtLeastOneWhateverAWorkerClaims) {
  for (const double speed : {0.0, -1.0, 1e-300, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(next_lease_size(kOptions, {1, speed}, kPlenty, 1).mean_samples, 1) << speed;
  }
  EXPECT_EQ(next_lease_size(kOptions, {1, std::numeric_limits<double>::infinity()}, 7, 1).mean_samples, 7);
  EXPECT_GE(next_lease_size(kOptions, {-5, std::nullopt}, kPlenty, 0).mean_samples, 1);
}

TEST(LearnCost, IsTheSameWhicheverMachinesServeAJob) {
  Estimate cheap, dear, fast, slow;
  learn_cost(cheap, fast, 1, 1e-5);
  learn_cost(cheap, slow, 1, 50e-5);
  for (int i = 0; i < 10; ++i) learn_cost(dear, slow, 1, 100e-5);
  for (int i = 0; i < 10; ++i) learn_cost(cheap, fast, 1, 1e-5);
  EXPECT_NEAR(dear.value / cheap.value, 2, 1e-9);
}

TEST(LearnCost, IsExactAtOnceAmongEqualMachines) {
  Estimate cheap, dear, first, second;
  learn_cost(cheap, first, 4, 1e-5);
  learn_cost(dear, second, 4, 100e-5);
  EXPECT_NEAR(dear.value / cheap.value, 100, 1e-9);
}

TEST(LearnCost, MendsWhatAWorkerClaimed) {
  Estimate a, b, honest, liar;
  learn_cost(a, honest, 1, 1e-5);
  for (const double seconds : {1e-5, 5e-324, 1e-300, 1e308, 1e308, 1e308}) {
    learn_cost(a, liar, 1, seconds);
    EXPECT_TRUE(a.value > 0 && std::isfinite(a.value) && liar.value > 0 && std::isfinite(liar.value))
        << seconds;
  }
  for (int i = 0; i < 100; ++i) {
    learn_cost(a, honest, 1, 1e-5);
    learn_cost(b, honest, 1, 1e-5);
  }
  EXPECT_NEAR(a.value / b.value, 1, 1e-3);
}

TEST(Patience, IsTenTimesTheLeaseDurationOrWhatIsHeldShouldTakeAndAnHourAtMost) {
  using std::chrono::seconds;
  EXPECT_EQ(patience(seconds(10), 0), seconds(100));
  EXPECT_EQ(patience(seconds(10), 9.9), seconds(100));
  EXPECT_EQ(patience(seconds(10), 30), seconds(300));
  EXPECT_EQ(patience(seconds(1), 0), seconds(10));
  for (const double endless : {1e6, 1e300, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(patience(seconds(10), endless), seconds(3600)) << endless;
}

TEST(BarAfter, DoublesWithEachTimeInARowButNotForEver) {
  using std::chrono::seconds;
  EXPECT_EQ(cooldown_after(seconds(100), 0), seconds(100));
  EXPECT_EQ(cooldown_after(seconds(100), 3), seconds(800));
  EXPECT_EQ(cooldown_after(seconds(100), 1'000'000), seconds(102'400));
}

TEST(ChooseJob, TakesTheHighestPriorityFirst) {
  EXPECT_EQ(choose_job(std::vector<JobSnapshot>{{-1, 0, 0}, {5, 100, 9}, {0, 0, 0}}), 1u);
}

TEST(ChooseJob, AmongEqualsTakesTheOneWithTheLeastWorkInFlight) {
  EXPECT_EQ(choose_job(std::vector<JobSnapshot>{{0, 3.5, 1}, {0, 2.5, 2}, {0, 4, 0}}), 1u);
}

TEST(ChooseJob, AmongThoseTakesTheOneThatHasWaitedLongest) {
  EXPECT_EQ(choose_job(std::vector<JobSnapshot>{{0, 0, 7}, {0, 0, 3}, {0, 0, 5}}), 1u);
}

TEST(ChooseJob, AmongThoseTakesTheFirst) {
  EXPECT_EQ(choose_job(std::vector<JobSnapshot>{{0, 1, 0}, {0, 0, 0}, {0, 0, 0}}), 1u);
}

}  // namespace
}  // namespace tessera::scheduler
