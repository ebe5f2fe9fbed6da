#include "tests/simulation/farm.hpp"

#include "tests/simulation/calm_farm.hpp"
#include "tests/simulation/rough_farm.hpp"

namespace tessera::simulation {

namespace {

// One farm of so many has no unrest at all.
constexpr std::uint64_t kCalmFarms = 100;

}  // namespace

FarmReport simulate_farm(std::uint64_t seed, bool verbose) {
  if (seed % kCalmFarms == 0) return simulate_calm_farm(seed, verbose);
  return RoughFarm(seed, verbose).run();
}

}  // namespace tessera::simulation
