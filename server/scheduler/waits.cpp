// SPDX-License-Identifier: Apache-2.0
// Jobs that lack nothing but audits by lot: how long they wait for a worker that could do these.
#include <algorithm>
#include <set>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {
bool Scheduler::lacks_only_lots(const Job& job) {
  return job.state() == JobState::kRunning && job.complete() && !job.settled() && !job.audits().any_doubted();
}

// Workers that cannot build the scene, or have stalled, are given the job again and again, so they are not
// waited for.
bool Scheduler::is_no_help(const Job& job, const Worker& worker) {
  const JobNotes* const known = worker.notes.find(job.run());
  return worker.stuck || (known != nullptr && (known->refused || worker.has_stalled(job.run())));
}

std::optional<WorkerId> Scheduler::find_auditor_at_work(const Job& job) const {
  for (const auto& [id, lease] : job.audit_leases().all())
    if (!is_no_help(job, *registry_.find(lease.holder))) return lease.holder;
  return std::nullopt;
}

bool Scheduler::would_audit(const Job& job, const WorkerId& id) const {
  const Worker* const worker = registry_.find(id);
  return worker != nullptr && worker->is_available() && can_render(*worker, job) &&
         !is_no_help(job, *worker) && can_audit(job, *worker);
}

std::optional<WorkerId> Scheduler::find_auditor_among(const Job& job,
                                                      const std::set<WorkerId>& workers) const {
  const auto found =
      std::find_if(workers.begin(), workers.end(), [&](const WorkerId& id) { return would_audit(job, id); });
  return found == workers.end() ? std::nullopt : std::optional<WorkerId>(*found);
}

// Looks first where most workers could audit: at those of other identities than one of the producers. Skips
// only distrusted workers, that producer, and such as are no help in this job.
std::optional<WorkerId> Scheduler::find_auditor(const Job& job) const {
  if (const auto auditor = find_auditor_at_work(job)) return auditor;
  const Producer* const producer = job.audits().any_waiting_producer(producers_);
  if (producer == nullptr) return std::nullopt;
  const WorkerId& before = audit_waits_.last_auditor(job.number());
  if (would_audit(job, before)) return before;
  const auto& by_identity = registry_.available_by_identity();
  const Identity own = identity_of(*producer);
  for (const auto& [identity, workers] : by_identity) {
    if (identity == own) continue;
    if (const auto auditor = find_auditor_among(job, workers)) return auditor;
  }
  const bool others_wait = job.audits().excluded(producers_) == kNoIdentity;
  const auto alike = by_identity.find(own);
  if (!others_wait || alike == by_identity.end()) return std::nullopt;
  return find_auditor_among(job, alike->second);
}

void Scheduler::look_for_auditor(JobNumber number) {
  audit_waits_.looked_at(number, workers_version(), find_auditor(jobs_.at(number)), now_);
}

void Scheduler::end_hopeless_waits(Actions& actions) {
  refresh_indexes();
  for (; left_.unaudited_jobs > 0; --left_.unaudited_jobs) {
    const std::optional<JobNumber> outdated = audit_waits_.next_outdated(workers_version());
    if (!outdated) break;
    look_for_auditor(*outdated);
  }
  const auto most = static_cast<std::size_t>(std::max(left_.unaudited_jobs, 1));
  std::vector<JobNumber> due = audit_waits_.due(now_, most);
  std::sort(due.begin(), due.end());
  for (const JobNumber number : due) {
    look_for_auditor(number);
    const bool is_over = audit_waits_.is_due(number, now_) && !reviews_.contains(number);
    if (is_over) give_up_audits(at(number), actions);
  }
}

// In a job with very many, some events are needed for all of them.
void Scheduler::give_up_audits(Job& job, Actions& actions) {
  const std::size_t waived = job.waive_audits(static_cast<std::size_t>(options_.per_event.waived_audits));
  if (!settled(job)) return;
  actions.unaudited.push_back({job.id(), waived});
  become(job, JobState::kDone, actions);
}

}  // namespace tessera::scheduler
