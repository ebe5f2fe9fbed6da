// SPDX-License-Identifier: Apache-2.0
#include "server/farm/totals.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <numeric>

#include "server/farm/state_lock.hpp"

namespace tessera::farm {

Totals totals_of(Farm& farm) {
  const StateLock lock(farm);
  return {.scheduler = lock->scheduler.totals(lock.now()),
          .validating_jobs = lock->validating.size(),
          .ended_unvalidated = lock->ended_unvalidated,
          .waiting_calls = lock->waiting.size(),
          .quarantined_workers = lock->quarantine.size()};
}

std::string summary_of(const Totals& totals) {
  using scheduler::JobState;
  using scheduler::WorkerActivity;
  const auto jobs = [&](JobState state) { return totals.scheduler.jobs.at(static_cast<std::size_t>(state)); };
  const auto workers = [&](WorkerActivity activity) {
    return totals.scheduler.workers.at(static_cast<std::size_t>(activity));
  };
  const auto all =
      std::accumulate(totals.scheduler.workers.begin(), totals.scheduler.workers.end(), std::uint64_t{0});
  return fmt::format("{} jobs running, {} validating; {} workers, {} of them busy", jobs(JobState::kRunning),
                     totals.validating_jobs, all - workers(WorkerActivity::kSilent),
                     workers(WorkerActivity::kBusy));
}

}  // namespace tessera::farm
