// SPDX-License-Identifier: Apache-2.0
// Simulates a whole farm: machines, users and faults for a while; then without faults, when everything must
// complete.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tessera::simulation {

struct FarmReport {
  // The first violation, with the virtual time; empty if there was none.
  std::optional<std::string> failure;
  double virtual_seconds = 0;
  std::uint64_t events = 0;
  // Follows from every decision of the scheduler (digest.hpp).
  std::uint64_t digest = 0;
};

// A deterministic function of the seed. Verbose: prints a transcript.
FarmReport simulate_farm(std::uint64_t seed, bool verbose);

}  // namespace tessera::simulation
