// Whole farms against the real scheduler in virtual time, each from a seed.
//   TESSERA_SIM_FARMS=N    how many (default 1000)
//   TESSERA_SIM_SEED=S     only the farm of this seed, with a transcript
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/simulation/farm.hpp"

namespace tessera::simulation {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::stoull(text);
}

TEST(FarmSimulation, EveryJobIsRenderedExactlyOnceWhateverHappens) {
  const bool replay = std::getenv("TESSERA_SIM_SEED") != nullptr;
  const std::uint64_t first = from_environment("TESSERA_SIM_SEED", 1);
  const std::uint64_t farms = replay ? 1 : from_environment("TESSERA_SIM_FARMS", 1000);
  double virtual_seconds = 0;
  std::uint64_t events = 0;
  for (std::uint64_t seed = first; seed < first + farms; ++seed) {
    const FarmReport report = simulate_farm(seed, replay);
    ASSERT_FALSE(report.failure) << *report.failure << "\nreplay with TESSERA_SIM_SEED=" << seed;
    virtual_seconds += report.virtual_seconds;
    events += report.events;
  }
  fmt::print("{} farms, {:.1f} hours, {} events\n", farms, virtual_seconds / 3600, events);
}

// Otherwise a seed would not replay.
TEST(FarmSimulation, FollowsFromItsSeed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FarmReport a = simulate_farm(seed, false), b = simulate_farm(seed, false);
    EXPECT_EQ(a.events, b.events);
    EXPECT_EQ(a.virtual_seconds, b.virtual_seconds);
  }
}

}  // namespace
}  // namespace tessera::simulation
