// SPDX-License-Identifier: Apache-2.0
// Workers that are presumed dead: their deaths count against the samples that they had leased. Part of the
// scheduler.
#pragma once

#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"
#include "server/scheduler/leases.hpp"
#include "server/scheduler/quorum.hpp"

namespace tessera::scheduler {

class Losses {
 public:
  Losses(FarmState& farm, Leases& leases, Jobs& jobs)
      : farm_(farm), leases_(leases), jobs_(jobs), quorum_(farm) {}

  // Ends a lease whose holder is presumed dead, and counts that against its samples.
  void lose_lease(const Worker& worker, const HeldLease& held, Actions& actions);
  // The worker is alive: withdraws the strikes if it was presumed dead.
  void withdraw_strikes(const WorkerId& worker);

 private:
  FarmState& farm_;
  Leases& leases_;
  Jobs& jobs_;
  const Quorum quorum_;
};

}  // namespace tessera::scheduler
