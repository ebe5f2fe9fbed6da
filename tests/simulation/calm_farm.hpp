// SPDX-License-Identifier: Apache-2.0
// A farm without faults, which therefore must be fair and busy.
#pragma once

#include <cstdint>

#include "tests/simulation/farm.hpp"

namespace tessera::simulation {

// A deterministic function of the seed. Verbose: prints a transcript and the measured figures.
FarmReport simulate_calm_farm(std::uint64_t seed, bool verbose);

}  // namespace tessera::simulation
