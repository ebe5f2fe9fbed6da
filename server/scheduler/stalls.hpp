// SPDX-License-Identifier: Apache-2.0
// Stalled workers, which send heartbeats but deliver nothing: they keep no lease for ever, and samples that
// never end keep only a few workers. Part of the scheduler.
#pragma once

#include <optional>
#include <set>

#include "server/scheduler/eligibility.hpp"
#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"
#include "server/scheduler/leases.hpp"
#include "server/scheduler/quorum.hpp"

namespace tessera::scheduler {

class Stalls {
 public:
  Stalls(FarmState& farm, Leases& leases, Jobs& jobs)
      : farm_(farm), leases_(leases), jobs_(jobs), eligibility_(farm), quorum_(farm) {}

  // Ends a worker's leases of each job to which it has contributed nothing for too long.
  void end_stalled_leases(Worker& worker, Actions& actions);
  // A stuck worker has synchronised: it goes on, or it was stuck long enough to count against its samples.
  void look_after_stuck(Worker& worker, Actions& actions);

 private:
  std::set<JobId> stalled_jobs(const Worker& worker) const;
  void stall(Worker& worker, const JobId& job, Actions& actions);
  // Returns its length; none for a worker that fetches the job's files.
  Duration begin_cooldown(Worker& worker, Job& job, Duration without_progress);
  // The samples in which the worker is stuck, if that is why its leases of these jobs stalled.
  std::optional<Stuck> what_keeps(const Worker& worker, const std::set<JobId>& stalled) const;
  void strike_stuck_ranges(Worker& worker, Actions& actions);
  void give_up_if_nobody_gets_on(Job& job, Actions& actions);

  FarmState& farm_;
  Leases& leases_;
  Jobs& jobs_;
  const Eligibility eligibility_;
  const Quorum quorum_;
};

}  // namespace tessera::scheduler
