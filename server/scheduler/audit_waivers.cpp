// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/audit_waivers.hpp"

#include <algorithm>

namespace tessera::scheduler {

void AuditWaivers::look_for_auditor(JobNumber number) {
  farm_.audit_waits.looked_at(number, farm_.workers_version(), auditors_.find(farm_.jobs.at(number)),
                              farm_.now);
}

void AuditWaivers::end_hopeless_waits(Actions& actions) {
  jobs_.refresh_indexes();
  for (; farm_.step.left.unaudited_jobs > 0; --farm_.step.left.unaudited_jobs) {
    const std::optional<JobNumber> outdated = farm_.audit_waits.next_outdated(farm_.workers_version());
    if (!outdated) break;
    look_for_auditor(*outdated);
  }
  const auto most = static_cast<std::size_t>(std::max(farm_.step.left.unaudited_jobs, 1));
  std::vector<JobNumber> due = farm_.audit_waits.due(farm_.now, most);
  std::sort(due.begin(), due.end());
  for (const JobNumber number : due) {
    look_for_auditor(number);
    const bool is_over = farm_.audit_waits.is_due(number, farm_.now) && !farm_.reviews.contains(number);
    if (is_over) give_up(farm_.at(number), actions);
  }
}

// In a job with very many, some events are needed for all of them.
void AuditWaivers::give_up(Job& job, Actions& actions) {
  const std::size_t waived =
      job.waive_audits(static_cast<std::size_t>(farm_.options.per_event.waived_audits));
  if (!farm_.settled(job)) return;
  actions.unaudited.push_back({job.id(), waived});
  jobs_.become(job, JobState::kDone, actions);
}

}  // namespace tessera::scheduler
