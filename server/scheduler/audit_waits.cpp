// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/audit_waits.hpp"

namespace tessera::scheduler {

void AuditWaits::enter(JobNumber job) {
  set_version(job, waits_[job], 0);
}

void AuditWaits::leave(JobNumber job) {
  const auto wait = waits_.find(job);
  if (wait == waits_.end()) return;
  set_since(job, wait->second, std::nullopt);
  by_version_.erase({wait->second.version, job});
  waits_.erase(wait);
}

std::optional<JobNumber> AuditWaits::next_outdated(std::uint64_t version) const {
  if (by_version_.empty() || by_version_.begin()->first >= version) return std::nullopt;
  return by_version_.begin()->second;
}

void AuditWaits::looked_at(JobNumber job, std::uint64_t version, const std::optional<WorkerId>& auditor,
                           Time now) {
  Wait& wait = waits_.at(job);
  set_version(job, wait, version);
  if (auditor) {
    wait.auditor = *auditor;
    set_since(job, wait, std::nullopt);
  } else if (!wait.since) {
    set_since(job, wait, now);
  }
}

std::vector<JobNumber> AuditWaits::due(Time now, std::size_t most) const {
  std::vector<JobNumber> jobs;
  for (const auto& [deadline, job] : by_deadline_) {
    if (deadline > now || jobs.size() == most) break;
    jobs.push_back(job);
  }
  return jobs;
}

bool AuditWaits::is_due(JobNumber job, Time now) const {
  const auto wait = waits_.find(job);
  return wait != waits_.end() && wait->second.since && *wait->second.since + patience_ <= now;
}

std::optional<Time> AuditWaits::next_deadline() const {
  return by_deadline_.empty() ? std::nullopt : std::optional<Time>(by_deadline_.begin()->first);
}

void AuditWaits::set_version(JobNumber job, Wait& wait, std::uint64_t version) {
  by_version_.erase({wait.version, job});
  wait.version = version;
  by_version_.insert({version, job});
}

void AuditWaits::set_since(JobNumber job, Wait& wait, std::optional<Time> since) {
  if (wait.since) by_deadline_.erase({*wait.since + patience_, job});
  wait.since = since;
  if (since) by_deadline_.insert({*since + patience_, job});
}

}  // namespace tessera::scheduler
