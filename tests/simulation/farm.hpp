// SPDX-License-Identifier: Apache-2.0
// A whole farm for a while: machines, users, faults; then calm, in which everything must come to its end.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tessera::simulation {

struct FarmReport {
  // What went wrong, with the virtual time; absent if nothing did.
  std::optional<std::string> failure;
  double virtual_seconds = 0;
  std::uint64_t events = 0;
};

// Everything that happens follows from the seed. Verbose: prints a transcript.
FarmReport simulate_farm(std::uint64_t seed, bool verbose);

}  // namespace tessera::simulation
