// SPDX-License-Identifier: Apache-2.0
// Jobs that lack nothing but audits by lot: how long they wait for a worker that could do these.
#include <algorithm>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {

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
