// SPDX-License-Identifier: Apache-2.0
// A farm in which one sample of one job never comes to an end, and nothing else goes wrong: that job fails
// for it, and the other is done.
#pragma once

#include <cstdint>

#include "tests/simulation/farm.hpp"

namespace tessera::simulation {

// Everything that happens follows from the seed. Verbose: prints a transcript.
FarmReport simulate_kept_farm(std::uint64_t seed, bool verbose);

}  // namespace tessera::simulation
