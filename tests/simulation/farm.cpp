// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/farm.hpp"

#include "tests/simulation/calm_farm.hpp"
#include "tests/simulation/kept_farm.hpp"
#include "tests/simulation/rough_farm.hpp"
#include "tests/simulation/scripted_farm.hpp"

namespace tessera::simulation {

namespace {

// One farm in so many has no faults, one has only a sample that never ends, and one follows a script.
constexpr std::uint64_t kQuietFarms = 100, kKeptFarm = 50, kScriptedFarm = 25;

}  // namespace

FarmReport simulate_farm(std::uint64_t seed, bool verbose) {
  if (seed % kQuietFarms == 0) return simulate_calm_farm(seed, verbose);
  if (seed % kQuietFarms == kKeptFarm) return simulate_kept_farm(seed, verbose);
  if (seed % kQuietFarms == kScriptedFarm) return simulate_scripted_farm(seed, verbose);
  return RoughFarm(seed, verbose).run();
}

}  // namespace tessera::simulation
