// SPDX-License-Identifier: Apache-2.0
// The lifecycle of jobs: they are added, change their state and leave, with all that follows. Part of the
// scheduler.
#pragma once

#include <vector>

#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/leases.hpp"

namespace tessera::scheduler {

class Jobs {
 public:
  Jobs(FarmState& farm, Leases& leases) : farm_(farm), leases_(leases) {}

  // Null, with Actions::status, if there is no such job.
  Job* find_or_refuse(const JobId& id, Actions& actions);
  core::Status may_add(const JobId& id, const JobShape& shape) const;
  Job& add(const JobId& id, const JobShape& shape, const SchedulingPolicy& policy, JobState state,
           const std::vector<IntervalSet>& done, Actions& actions);
  // The only function that changes a job's state, with all consequences. Refuses invalid transitions.
  void become(Job& job, JobState to, Actions& actions);
  void remove(Job& job, Actions& actions);
  // The job must be running or paused.
  void fail(Job& job, const Failure& failure, Actions& actions);
  // Enters jobs that may have changed in the indexes again.
  void refresh_indexes();

 private:
  FarmState& farm_;
  Leases& leases_;
};

}  // namespace tessera::scheduler
