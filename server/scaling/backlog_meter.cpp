// SPDX-License-Identifier: Apache-2.0
#include "server/scaling/backlog_meter.hpp"

#include <algorithm>
#include <cstddef>

namespace tessera::scaling {
namespace {

constexpr double kAveragedSeconds = 30;

}  // namespace

Backlog BacklogMeter::measure(const farm::Totals& totals, Clock::time_point now) {
  note_speed(totals.scheduler, now);
  const auto samples =
      static_cast<double>(totals.scheduler.missing_samples + totals.scheduler.samples_to_verify);
  Backlog backlog;
  backlog.has_work = samples > 0 || totals.validating_jobs > 0;
  if (!backlog.has_work) return backlog;
  const double seconds = samples_per_worker_second_ > 0 ? samples / samples_per_worker_second_ : 0;
  backlog.worker_seconds = std::max(seconds, 1.0);
  return backlog;
}

void BacklogMeter::note_speed(const scheduler::Totals& totals, Clock::time_point now) {
  const auto busy =
      static_cast<double>(totals.workers[static_cast<std::size_t>(scheduler::WorkerActivity::kBusy)]);
  if (busy == 0 || totals.samples_per_second <= 0) return;
  const double speed = totals.samples_per_second / busy;
  const double passed = std::chrono::duration<double>(now - noted_at_).count();
  const double weight = samples_per_worker_second_ > 0 ? std::min(passed / kAveragedSeconds, 1.0) : 1.0;
  samples_per_worker_second_ += weight * (speed - samples_per_worker_second_);
  noted_at_ = now;
}

}  // namespace tessera::scaling
