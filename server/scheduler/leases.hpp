// SPDX-License-Identifier: Apache-2.0
// Leases begin and end: what their holders, their jobs and the indexes are told of it, and what workers still
// hold of runs that have ended. Part of the scheduler.
#pragma once

#include <set>
#include <vector>

#include "server/scheduler/farm_state.hpp"

namespace tessera::scheduler {

class Leases {
 public:
  explicit Leases(FarmState& farm) : farm_(farm) {}

  // ---- Single leases (leases.cpp) ----
  void enter(Worker& worker, Job& job, Lease lease);
  Lease end(Job& job, LeaseId id, LeaseState to);
  // The worker's leases go to others, and it is given nothing until it asks again.
  void end_all(Worker& worker);
  // Removes an ended lease from its holder's entry.
  void forget(const Job& job, const Lease& lease);
  // The same for leases that ended because nothing of them is missing.
  void forget_emptied(const Job& job, const std::vector<Lease>& leases);
  // Wakes workers whose leases have shrunk.
  void shorten(const std::vector<WorkerId>& workers);

  // ---- Runs that end (ended_runs.cpp) ----
  JobNotes& notes(Worker& worker, const Job& job);
  Effort& effort(Worker& worker, const Job& job);
  // Ends a run of the job: revokes its leases, and makes all notes of it stale.
  void end_run(Job& job, Actions& actions);
  // Revokes as many leases of ended runs as the present event may.
  void clear_ended_runs(Actions& actions);
  // Revokes all that the worker holds of ended runs.
  void revoke_ended(Worker& worker);

 private:
  void forget_held(Worker& holder, LeaseId lease);
  void count_ended(LeaseState state);
  bool clear_one_of(EndedRun& run);
  void revoke(EndedRun& run, LeaseId lease);
  void forget_refusal(const WorkerId& worker, RunNumber run);

  FarmState& farm_;
};

}  // namespace tessera::scheduler
