// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/unattended_audits.hpp"

namespace tessera::scheduler {

void UnattendedAudits::enter(JobNumber job, Time now) {
  if (since_.emplace(job, now).second) unreported_.emplace(now, job);
}

void UnattendedAudits::leave(JobNumber job) {
  const auto found = since_.find(job);
  if (found == since_.end()) return;
  unreported_.erase({found->second, job});
  since_.erase(found);
}

std::vector<JobNumber> UnattendedAudits::take_due(Time now, Duration patience, std::size_t most) {
  std::vector<JobNumber> due;
  while (due.size() < most && !unreported_.empty() && unreported_.begin()->first + patience <= now) {
    due.push_back(unreported_.begin()->second);
    unreported_.erase(unreported_.begin());
  }
  return due;
}

}  // namespace tessera::scheduler
