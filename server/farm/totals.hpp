// SPDX-License-Identifier: Apache-2.0
// What can be counted of a farm, at one moment. Thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "server/farm/farm.hpp"

namespace tessera::farm {

struct Totals {
  scheduler::Totals scheduler;  // its jobs are those in memory that are validated
  std::size_t validating_jobs = 0;
  std::array<std::uint64_t, scheduler::kJobStates> ended_unvalidated{};  // State::ended_unvalidated
  std::size_t waiting_calls = 0;
  std::size_t quarantined_workers = 0;
};

// Takes the state lock for a copy that does not depend on the size of the farm.
Totals totals_of(Farm& farm);

// "2 jobs running, 1 validating; 12 workers, 10 of them busy", of the workers that are heard.
std::string summary_of(const Totals& totals);

}  // namespace tessera::farm
