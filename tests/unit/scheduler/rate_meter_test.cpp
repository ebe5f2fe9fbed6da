// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/rate_meter.hpp"

#include <gtest/gtest.h>

namespace tessera::scheduler {
namespace {

using std::chrono::milliseconds;

TEST(RateMeter, IsUnknownAtFirst) {
  RateMeter meter;
  EXPECT_EQ(meter.per_second(Time{}), 0);
  meter.add(1000, Time{});
  EXPECT_EQ(meter.per_second(Time{} + milliseconds(400)), 0);
}

TEST(RateMeter, MeasuresASteadyRateFromTheStart) {
  RateMeter meter;
  Time now{};
  meter.add(0, now);
  for (int i = 0; i < 10; ++i) meter.add(100, now += milliseconds(100));
  EXPECT_NEAR(meter.per_second(now), 1000, 70);
  for (int i = 0; i < 1000; ++i) meter.add(100, now += milliseconds(100));
  EXPECT_NEAR(meter.per_second(now), 1000, 10);
}

TEST(RateMeter, ForgetsWhatIsLongAgo) {
  RateMeter meter;
  Time now{};
  for (int i = 0; i < 100; ++i) meter.add(100, now += milliseconds(100));
  EXPECT_LT(meter.per_second(now + std::chrono::minutes(2)), 0.01);
}

}  // namespace
}  // namespace tessera::scheduler
