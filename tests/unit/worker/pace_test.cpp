// SPDX-License-Identifier: Apache-2.0
#include "worker/pace.hpp"

#include <gtest/gtest.h>

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;

TEST(Pace, ComesToAQuarterOfASecond) {
  Pace pace;
  constexpr double kSamplesPerSecond = 1e6;
  std::uint64_t samples = pace.target_samples("job");
  EXPECT_EQ(samples, 4096u);
  for (int i = 0; i < 10; ++i) {
    pace.measured("job", samples,
                  std::chrono::duration<double>(static_cast<double>(samples) / kSamplesPerSecond));
    samples = pace.target_samples("job");
  }
  EXPECT_EQ(samples, 250'000u);
}

TEST(Pace, SlowsDownAtOnceAndSpeedsUpStepByStep) {
  Pace pace;
  pace.measured("job", 100'000, 10s);
  EXPECT_EQ(pace.target_samples("job"), 2'500u);
  pace.measured("job", 2'500, 0s);
  EXPECT_EQ(pace.target_samples("job"), 4 * 4096u);
}

TEST(Pace, KnowsNothingOfAnotherJob) {
  Pace pace;
  pace.measured("fast", 1'000'000, 10ms);
  EXPECT_EQ(pace.target_samples("slow"), 4096u);
}

}  // namespace
}  // namespace tessera::worker
