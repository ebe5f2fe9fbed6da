// SPDX-License-Identifier: Apache-2.0
// Which workers could audit a job that lacks nothing else.
#include <algorithm>
#include <set>

#include "server/scheduler/farm_state.hpp"

namespace tessera::scheduler {

bool FarmState::lacks_only_lots(const Job& job) {
  return job.state() == JobState::kRunning && job.complete() && !job.settled() && !job.audits().any_doubted();
}

// Workers that cannot build the scene, or have stalled, are given the job again and again, so they are not
// waited for.
bool FarmState::is_no_help(const Job& job, const Worker& worker) {
  const JobNotes* const known = worker.notes.find(job.run());
  return worker.stuck || (known != nullptr && (known->refused || worker.has_stalled(job.run())));
}

std::optional<WorkerId> FarmState::find_auditor_at_work(const Job& job) const {
  for (const auto& [id, lease] : job.audit_leases().all())
    if (!is_no_help(job, *registry_.find(lease.holder))) return lease.holder;
  return std::nullopt;
}

bool FarmState::would_audit(const Job& job, const WorkerId& id) const {
  const Worker* const worker = registry_.find(id);
  return worker != nullptr && worker->is_available() && can_render(*worker, job) &&
         !is_no_help(job, *worker) && can_audit(job, *worker);
}

std::optional<WorkerId> FarmState::find_auditor_among(const Job& job,
                                                      const std::set<WorkerId>& workers) const {
  const auto found =
      std::find_if(workers.begin(), workers.end(), [&](const WorkerId& id) { return would_audit(job, id); });
  return found == workers.end() ? std::nullopt : std::optional<WorkerId>(*found);
}

// Looks first where most workers could audit: at those of other identities than one of the producers. Skips
// only distrusted workers, that producer, and such as are no help in this job.
std::optional<WorkerId> FarmState::find_auditor(const Job& job) const {
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

}  // namespace tessera::scheduler
