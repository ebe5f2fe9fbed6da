// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/auditors.hpp"

#include <algorithm>

namespace tessera::scheduler {

bool lacks_only_lots(const Job& job) {
  return job.state() == JobState::kRunning && job.complete() && !job.settled() && !job.audits().any_doubted();
}

bool is_unattended(const Job& job) {
  return job.state() == JobState::kRunning && job.complete() && job.to_verify() > 0 &&
         job.holder_count() == 0;
}

// Workers that cannot build the scene, or have stalled, are given the job again and again, so they are not
// waited for.
bool Auditors::is_no_help(const Job& job, const Worker& worker) {
  const JobNotes* const known = worker.notes.find(job.run());
  return worker.stuck || (known != nullptr && (known->refused || worker.has_stalled(job.run())));
}

std::optional<WorkerId> Auditors::find_at_work(const Job& job) const {
  for (const auto& [id, lease] : job.audit_leases().all())
    if (!is_no_help(job, *farm_.registry.find(lease.holder))) return lease.holder;
  return std::nullopt;
}

bool Auditors::would_audit(const Job& job, const WorkerId& id) const {
  const Worker* const worker = farm_.registry.find(id);
  return worker != nullptr && worker->is_available() && Eligibility::can_render(*worker, job) &&
         !is_no_help(job, *worker) && eligibility_.can_audit(job, *worker);
}

std::optional<WorkerId> Auditors::find_among(const Job& job, const std::set<WorkerId>& workers) const {
  const auto found =
      std::find_if(workers.begin(), workers.end(), [&](const WorkerId& id) { return would_audit(job, id); });
  return found == workers.end() ? std::nullopt : std::optional<WorkerId>(*found);
}

// Looks first where most workers could audit: at those of other identities than one of the producers. Skips
// only distrusted workers, that producer, and such as are no help in this job.
std::optional<WorkerId> Auditors::find(const Job& job) const {
  if (const auto auditor = find_at_work(job)) return auditor;
  const Producer* const producer = job.audits().any_waiting_producer(farm_.producers);
  if (producer == nullptr) return std::nullopt;
  const WorkerId& before = farm_.audit_waits.last_auditor(job.number());
  if (would_audit(job, before)) return before;
  const auto& by_identity = farm_.registry.available_by_identity();
  const Identity own = identity_of(*producer);
  for (const auto& [identity, workers] : by_identity) {
    if (identity == own) continue;
    if (const auto auditor = find_among(job, workers)) return auditor;
  }
  const bool others_wait = job.audits().excluded(farm_.producers) == kNoIdentity;
  const auto alike = by_identity.find(own);
  if (!others_wait || alike == by_identity.end()) return std::nullopt;
  return find_among(job, alike->second);
}

}  // namespace tessera::scheduler
