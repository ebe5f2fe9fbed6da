// SPDX-License-Identifier: Apache-2.0
// Farms of a few machines that do, at given moments, what random farms hardly ever do in the order in which
// it matters: workers return after they were presumed dead, the last possible auditor leaves, a principal is
// quarantined, the coordinator crashes after that, and results wait for long.
#pragma once

#include <cstdint>

#include "tests/simulation/farm.hpp"

namespace tessera::simulation {

// Runs one of the scripts, by the seed. A deterministic function of the seed. Verbose: prints a transcript.
FarmReport simulate_scripted_farm(std::uint64_t seed, bool verbose);
inline constexpr std::uint64_t kScripts = 6;

}  // namespace tessera::simulation
