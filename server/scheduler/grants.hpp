// SPDX-License-Identifier: Apache-2.0
// Which work a worker is given next. Part of the scheduler.
#pragma once

#include "server/scheduler/eligibility.hpp"
#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"
#include "server/scheduler/leases.hpp"

namespace tessera::scheduler {

class Grants {
 public:
  Grants(FarmState& farm, Leases& leases, Jobs& jobs)
      : farm_(farm), leases_(leases), jobs_(jobs), eligibility_(farm) {}

  // Gives the worker what it wants, if there is work for it.
  void top_up(Worker& worker);

 private:
  // The job of which the worker is given its next lease. `also_refused`: include jobs that it has refused
  // lately.
  Job* choose(const Worker& worker, bool also_refused);
  bool grant_free(Worker& worker, bool also_refused);
  bool grant_copy(Worker& worker);
  void grant(Worker& worker, Job& job, Portion portion);
  void charge(Job& job, const Portion& portion);

  FarmState& farm_;
  Leases& leases_;
  Jobs& jobs_;
  const Eligibility eligibility_;
};

}  // namespace tessera::scheduler
