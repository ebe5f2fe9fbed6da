// SPDX-License-Identifier: Apache-2.0
// Jobs that lack nothing but audits by lot, and have waited long enough for a worker that could do these: the
// audits are waived. Part of the scheduler.
#pragma once

#include "server/scheduler/auditors.hpp"
#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"

namespace tessera::scheduler {

class AuditWaivers {
 public:
  AuditWaivers(FarmState& farm, Jobs& jobs) : farm_(farm), jobs_(jobs), auditors_(farm) {}

  // Jobs that have waited long enough are done without these audits.
  void end_hopeless_waits(Actions& actions);

 private:
  void look_for_auditor(JobNumber number);
  void give_up(Job& job, Actions& actions);

  FarmState& farm_;
  Jobs& jobs_;
  const Auditors auditors_;
};

}  // namespace tessera::scheduler
