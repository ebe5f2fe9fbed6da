// SPDX-License-Identifier: Apache-2.0
#include "server/farm/totals.hpp"

#include "server/farm/state_lock.hpp"

namespace tessera::farm {

Totals totals_of(Farm& farm) {
  const StateLock lock(farm);
  return {.scheduler = lock->scheduler.totals(lock.now()),
          .validating_jobs = lock->validating.size(),
          .waiting_calls = lock->waiting.size(),
          .quarantined_workers = lock->quarantine.entries().size()};
}

}  // namespace tessera::farm
