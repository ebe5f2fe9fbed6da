// SPDX-License-Identifier: Apache-2.0
// A farm in which one sample of one job never ends, without other faults: that job fails, and the other one
// is done.
#pragma once

#include <cstdint>

#include "tests/simulation/farm.hpp"

namespace tessera::simulation {

// A deterministic function of the seed. Verbose: prints a transcript.
FarmReport simulate_kept_farm(std::uint64_t seed, bool verbose);

}  // namespace tessera::simulation
