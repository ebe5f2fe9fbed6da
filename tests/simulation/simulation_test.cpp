// SPDX-License-Identifier: Apache-2.0
// A simulated farm is a deterministic function of its seed.
#include <gtest/gtest.h>

#include "tests/simulation/farm.hpp"
#include "tests/simulation/kept_farm.hpp"
#include "tests/simulation/scripted_farm.hpp"
#include "tests/support/effort.hpp"

namespace tessera::simulation {
namespace {

TEST(FarmSimulation, FollowsFromItsSeed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FarmReport a = simulate_farm(seed, false), b = simulate_farm(seed, false);
    EXPECT_EQ(a.failure, std::nullopt) << "seed " << seed;
    EXPECT_EQ(a.events, b.events);
    EXPECT_EQ(a.digest, b.digest);
    EXPECT_EQ(a.virtual_seconds, b.virtual_seconds);
  }
}

// For every sample, and all working habits of machines.
TEST(FarmSimulation, ASampleThatNeverEndsEndsItsJobAndNoOther) {
  for (std::uint64_t seed = 1; seed <= (test::kEffortDivisor == 1 ? 40 : 10); ++seed)
    EXPECT_EQ(simulate_kept_farm(seed, false).failure, std::nullopt) << "seed " << seed;
}

TEST(FarmSimulation, EveryScriptEndsAsItShould) {
  for (std::uint64_t seed = 0; seed < 100 * kScripts * 4; seed += 100)
    EXPECT_EQ(simulate_scripted_farm(seed, false).failure, std::nullopt) << "seed " << seed;
}

}  // namespace
}  // namespace tessera::simulation
