// SPDX-License-Identifier: Apache-2.0
// A farm in which nothing goes wrong, and which therefore must be fair and busy.
#pragma once

#include <cstdint>

#include "tests/simulation/farm.hpp"

namespace tessera::simulation {

// Everything that happens follows from the seed. Verbose: prints a transcript, and the figures that are
// judged.
FarmReport simulate_calm_farm(std::uint64_t seed, bool verbose);

}  // namespace tessera::simulation
