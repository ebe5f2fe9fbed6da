// SPDX-License-Identifier: Apache-2.0
// The sums of simulated renders: every honest worker gets the same number for a sample. Pure functions.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "server/scheduler/fingerprint.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::simulation {

inline scheduler::Fingerprint honest_sums(const scheduler::JobId& job, const scheduler::WorkItem& item) {
  scheduler::Fingerprint sums;
  for (std::uint32_t s = item.samples.begin; s < item.samples.end; ++s) {
    const auto place = static_cast<std::uint64_t>(item.tile) << 32 | s;
    const std::uint64_t value = (std::hash<std::string>{}(job.value) ^ place) * 0x9e3779b97f4a7c15;
    sums.add({value, value ^ value >> 31, 1});
  }
  return sums;
}

// Different sums, unless `lie` is 0.
inline scheduler::Fingerprint wrong_sums(const scheduler::JobId& job, const scheduler::WorkItem& item,
                                         std::uint64_t lie) {
  scheduler::Fingerprint sums = honest_sums(job, item);
  sums.low ^= lie;
  return sums;
}

}  // namespace tessera::simulation
