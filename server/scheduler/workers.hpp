// SPDX-License-Identifier: Apache-2.0
// Workers come, report, are drained and dismissed, and fall silent. Part of the scheduler.
#pragma once

#include "server/scheduler/eligibility.hpp"
#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/leases.hpp"
#include "server/scheduler/losses.hpp"
#include "server/scheduler/reviews.hpp"
#include "server/scheduler/stalls.hpp"

namespace tessera::scheduler {

class Workers {
 public:
  Workers(FarmState& farm, Leases& leases, Losses& losses, Stalls& stalls, Reviews& reviews)
      : farm_(farm),
        leases_(leases),
        losses_(losses),
        stalls_(stalls),
        reviews_(reviews),
        eligibility_(farm) {}

  // Each handles one event. Returns the worker that awaits a reply.
  Worker* on(const Synchronize& event, Actions& actions);
  Worker* on(const TopUp& event, Actions& actions);
  Worker* on(const Dismiss& event, Actions& actions);
  Worker* on(const Drain& event, Actions& actions);

  // Ends the leases of silent workers, as many as the present event may.
  void expire_workers(Actions& actions);
  // Does for the sender of an event what others may leave for later.
  void settle_sender(const Event& event, Actions& actions);

 private:
  void expire(Worker& worker, Actions& actions);
  void settle_reported(Worker& worker);
  void adopt(Worker& worker, const LeaseDescription& reported);

  FarmState& farm_;
  Leases& leases_;
  Losses& losses_;
  Stalls& stalls_;
  Reviews& reviews_;
  const Eligibility eligibility_;
};

}  // namespace tessera::scheduler
