// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/farm_state.hpp"

#include <algorithm>

namespace tessera::scheduler {
namespace {

// Whether all workers, which are counted by name or origin, are `these` or stalled ones. Skips only such
// ones.
bool are_all(const std::map<std::string, int>& workers, const std::set<std::string>& these,
             const std::map<std::string, int>& stalled) {
  return std::all_of(workers.begin(), workers.end(), [&](const auto& entry) {
    const auto found = stalled.find(entry.first);
    return these.contains(entry.first) || (found != stalled.end() && found->second == entry.second);
  });
}

}  // namespace

FarmState::FarmState(const Options& options)
    : options_(options),
      last_lease_id_{static_cast<std::uint64_t>(options.epoch) << kLeaseCounterBits},
      registry_(options.lease_duration, options.forget_after),
      audit_waits_(options.audit_patience) {}

const Job* FarmState::find(const JobId& id) const {
  const auto found = job_numbers_.find(id);
  return found == job_numbers_.end() ? nullptr : &jobs_.at(found->second);
}

std::optional<Time> FarmState::next_deadline() const {
  std::optional<Time> next = registry_.next_alarm();
  const auto at_latest = [&](Time time) { next = std::min(next.value_or(time), time); };
  if (const std::optional<Time> deadline = audit_waits_.next_deadline()) at_latest(*deadline);
  const bool has_backlog = waiting_.in_wave() || !ended_runs_.empty() || !reviews_.empty() ||
                           audit_waits_.next_outdated(workers_version());
  if (has_backlog) at_latest(now_);
  return next;
}

// A worker that is stuck never reports that it cannot build a scene.
std::map<std::string, int> FarmState::stalled_by(const Job& job, std::string WorkerInfo::*part) const {
  std::map<std::string, int> counts;
  for (const WorkerId& id : job.stalled_workers()) {
    const Worker* const worker = registry_.find(id);
    if (worker != nullptr && worker->is_available() && worker->has_stalled(job.run()))
      ++counts[worker->info.*part];
  }
  return counts;
}

AreAll FarmState::are_all_names(const Job& job) const {
  return [this, &job](const std::set<std::string>& names) {
    return are_all(registry_.available_by_name(), names, stalled_by(job, &WorkerInfo::name));
  };
}

AreAll FarmState::are_all_principals(const Job& job) const {
  return [this, &job](const std::set<std::string>& principals) {
    return are_all(registry_.available_by_origin(), principals, stalled_by(job, &WorkerInfo::origin));
  };
}

}  // namespace tessera::scheduler
