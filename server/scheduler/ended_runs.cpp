// SPDX-License-Identifier: Apache-2.0
// Runs of jobs that have ended: what workers still hold and know of them is taken from them a few leases at a
// time, and from each worker before it is next served.
#include <memory>
#include <utility>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {

JobNotes& Scheduler::notes(Worker& worker, const Job& job) {
  const auto in_use = [this](RunNumber run, const JobNotes& noted) {
    return runs_.contains(run) || noted.refused;  // forget_refusal() needs the latter
  };
  return worker.notes.at_or_insert(job.run(), in_use);
}

Effort& Scheduler::effort(Worker& worker, const Job& job) {
  std::optional<Effort>& known = notes(worker, job).effort;
  if (!known) known.emplace();
  return *known;
}

void Scheduler::end_run(Job& job, Actions& actions) {
  runs_.erase(job.run());
  EndedRun ended = job.begin_run(++last_run_number_);
  runs_.emplace(job.run(), job.number());
  ended_runs_.emplace(ended.number, std::move(ended));
  clear_ended_runs(actions);
}

void Scheduler::clear_ended_runs(Actions& actions) {
  while (!ended_runs_.empty() && left_.revoked_leases > 0) {
    if (clear_one_of(ended_runs_.begin()->second)) {
      --left_.revoked_leases;
      continue;
    }
    auto cleared = ended_runs_.extract(ended_runs_.begin());
    actions.discarded.push_back(std::make_shared<decltype(cleared)>(std::move(cleared)));
  }
}

// Whether anything was left.
bool Scheduler::clear_one_of(EndedRun& run) {
  for (const LeaseTable* const leases : {&run.leases, &run.audit_leases}) {
    if (leases->all().empty()) continue;
    revoke(run, leases->all().begin()->first);
    return true;
  }
  if (run.refusers.empty()) return false;
  forget_refusal(*run.refusers.begin(), run.number);
  run.refusers.erase(run.refusers.begin());
  return true;
}

void Scheduler::revoke(EndedRun& run, LeaseId id) {
  LeaseTable& leases = run.leases.find(id) != nullptr ? run.leases : run.audit_leases;
  forget_held(*registry_.find(leases.end(id, LeaseState::kRevoked).holder), id);
  count_ended(LeaseState::kRevoked);
}

void Scheduler::revoke_ended(Worker& worker) {
  if (ended_runs_.empty()) return;
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases)) {
    const auto ended = ended_runs_.find(held.run);
    if (ended != ended_runs_.end()) revoke(ended->second, held.id);
  }
}

void Scheduler::forget_refusal(const WorkerId& id, RunNumber run) {
  Worker* const worker = registry_.find(id);
  if (worker == nullptr) return;
  const JobNotes* const noted = worker->notes.find(run);
  if (noted == nullptr || !noted->refused) return;
  worker->refusals.erase({*noted->refused, run});
  worker->notes.erase(run);
  waiting_.update(*worker);
}

}  // namespace tessera::scheduler
