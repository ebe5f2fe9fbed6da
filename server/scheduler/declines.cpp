// SPDX-License-Identifier: Apache-2.0
// Workers that cannot build a scene, and who is left that might.
#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "server/scheduler/scheduler.hpp"

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

// A worker that is stuck never reports that it cannot build a scene.
std::map<std::string, int> Scheduler::stalled_by(const Job& job, std::string WorkerInfo::*part) const {
  std::map<std::string, int> counts;
  for (const WorkerId& id : job.stalled_workers()) {
    const Worker* const worker = registry_.find(id);
    if (worker != nullptr && worker->is_available() && worker->has_stalled(job.run()))
      ++counts[worker->info.*part];
  }
  return counts;
}

AreAll Scheduler::are_all_names(const Job& job) const {
  return [this, &job](const std::set<std::string>& names) {
    return are_all(registry_.available_by_name(), names, stalled_by(job, &WorkerInfo::name));
  };
}

AreAll Scheduler::are_all_principals(const Job& job) const {
  return [this, &job](const std::set<std::string>& principals) {
    return are_all(registry_.available_by_origin(), principals, stalled_by(job, &WorkerInfo::origin));
  };
}

void Scheduler::note_refusal(Job& job, const SubmitResult& event, Actions& actions) {
  Worker& worker = *registry_.find(event.worker);
  std::optional<Time>& refused = notes(worker, job).refused;
  if (refused) worker.refusals.erase({*refused, job.run()});
  refused = now_;
  worker.refusals.insert({now_, job.run()});
  waiting_.update(worker);
  job.note_refuser(event.worker);
  const auto failure = job.decline_reason({event.worker, worker.info.name, worker.info.origin},
                                          event.decline_reason, are_all_names(job), are_all_principals(job));
  if (failure) fail(job, *failure, actions);
}

}  // namespace tessera::scheduler
