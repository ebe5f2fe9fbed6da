// SPDX-License-Identifier: Apache-2.0
// Runs of jobs that have ended: what workers still hold and know of them is taken from them a few leases at a
// time, and from each worker before it is next served.
#include "server/scheduler/leases.hpp"

#include <memory>
#include <utility>

namespace tessera::scheduler {

JobNotes& Leases::notes(Worker& worker, const Job& job) {
  const auto in_use = [this](RunNumber run, const JobNotes& noted) {
    return farm_.runs.contains(run) || noted.refused;  // forget_refusal() needs the latter
  };
  return worker.notes.at_or_insert(job.run(), in_use);
}

Effort& Leases::effort(Worker& worker, const Job& job) {
  std::optional<Effort>& known = notes(worker, job).effort;
  if (!known) known.emplace();
  return *known;
}

void Leases::end_run(Job& job, Actions& actions) {
  farm_.runs.erase(job.run());
  EndedRun ended = job.begin_run(++farm_.last_run_number);
  farm_.runs.emplace(job.run(), job.number());
  farm_.ended_runs.emplace(ended.number, std::move(ended));
  clear_ended_runs(actions);
}

void Leases::clear_ended_runs(Actions& actions) {
  while (!farm_.ended_runs.empty() && farm_.step.left.revoked_leases > 0) {
    if (clear_one_of(farm_.ended_runs.begin()->second)) {
      --farm_.step.left.revoked_leases;
      continue;
    }
    auto cleared = farm_.ended_runs.extract(farm_.ended_runs.begin());
    actions.discarded.push_back(std::make_shared<decltype(cleared)>(std::move(cleared)));
  }
}

// Whether anything was left.
bool Leases::clear_one_of(EndedRun& run) {
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

void Leases::revoke(EndedRun& run, LeaseId id) {
  LeaseTable& leases = run.leases.find(id) != nullptr ? run.leases : run.audit_leases;
  forget_held(*farm_.registry.find(leases.end(id, LeaseState::kRevoked).holder), id);
  count_ended(LeaseState::kRevoked);
}

void Leases::revoke_ended(Worker& worker) {
  if (farm_.ended_runs.empty()) return;
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases)) {
    const auto ended = farm_.ended_runs.find(held.run);
    if (ended != farm_.ended_runs.end()) revoke(ended->second, held.id);
  }
}

void Leases::forget_refusal(const WorkerId& id, RunNumber run) {
  Worker* const worker = farm_.registry.find(id);
  if (worker == nullptr) return;
  const JobNotes* const noted = worker->notes.find(run);
  if (noted == nullptr || !noted->refused) return;
  worker->refusals.erase({*noted->refused, run});
  worker->notes.erase(run);
  farm_.waiting.update(*worker);
}

}  // namespace tessera::scheduler
