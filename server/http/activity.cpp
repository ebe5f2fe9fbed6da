// SPDX-License-Identifier: Apache-2.0
#include "server/http/activity.hpp"

namespace tessera::http_api {

ActivitySample activity_of(const farm::Totals& totals) {
  const scheduler::Totals& farm = totals.scheduler;
  return {.samples_per_second = farm.samples_per_second,
          .busy_workers = farm.workers[static_cast<std::size_t>(scheduler::WorkerActivity::kBusy)],
          .running_jobs = farm.jobs[static_cast<std::size_t>(scheduler::JobState::kRunning)]};
}

void ActivityLog::add(const ActivitySample& sample) {
  const core::MutexLock lock(mutex_);
  samples_.push_back(sample);
  if (samples_.size() > kKept) samples_.pop_front();
}

std::vector<ActivitySample> ActivityLog::samples() const {
  const core::MutexLock lock(mutex_);
  return {samples_.begin(), samples_.end()};
}

}  // namespace tessera::http_api
