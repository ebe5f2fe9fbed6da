// SPDX-License-Identifier: Apache-2.0
// Distrust: finds the unverified samples of distrusted workers, some tiles with each event. Part of the
// scheduler.
#pragma once

#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"
#include "server/scheduler/leases.hpp"

namespace tessera::scheduler {

class Reviews {
 public:
  Reviews(FarmState& farm, Leases& leases, Jobs& jobs) : farm_(farm), leases_(leases), jobs_(jobs) {}

  Worker* on(const Distrust& event, Actions& actions);
  Worker* on(const Trust& event, Actions& actions);

  void distrust(const Producer& producer, Actions& actions);
  // Searches as many tiles as the present event may.
  void advance(Actions& actions);

 private:
  bool review(Job& job, ReviewQueue::Position& position, Actions& actions);
  void finish(Job& job, bool reopened, Actions& actions);

  FarmState& farm_;
  Leases& leases_;
  Jobs& jobs_;
};

}  // namespace tessera::scheduler
