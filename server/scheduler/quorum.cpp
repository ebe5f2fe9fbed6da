// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/quorum.hpp"

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

// A worker that is stuck never reports that it cannot build a scene.
std::map<std::string, int> Quorum::stalled_by(const Job& job, std::string WorkerInfo::*part) const {
  std::map<std::string, int> counts;
  for (const WorkerId& id : job.stalled_workers()) {
    const Worker* const worker = farm_.registry.find(id);
    if (worker != nullptr && worker->is_available() && worker->has_stalled(job.run()))
      ++counts[worker->info.*part];
  }
  return counts;
}

AreAll Quorum::are_all_names(const Job& job) const {
  return [this, &job](const std::set<std::string>& names) {
    return are_all(farm_.registry.available_by_name(), names, stalled_by(job, &WorkerInfo::name));
  };
}

AreAll Quorum::are_all_principals(const Job& job) const {
  return [this, &job](const std::set<std::string>& principals) {
    return are_all(farm_.registry.available_by_origin(), principals, stalled_by(job, &WorkerInfo::origin));
  };
}

}  // namespace tessera::scheduler
