// SPDX-License-Identifier: Apache-2.0
// A scheduler with workers that never render, for measurements. Every worker wants two leases.
// Single-threaded.
#pragma once

#include <cstddef>
#include <vector>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {

class SchedulerFarm {
 public:
  SchedulerFarm() = default;

  // Jobs of 1920 x 1080 pixels that are never done.
  void add_jobs(int count);
  // They synchronise, and again with the leases that they are given.
  void add_workers(int count);

  // The time advances by a microsecond with each event.
  Actions handle(const Event& event);
  // The CPU time of the call alone.
  double seconds_of(const Event& event, Actions* actions);
  void pass(Duration time) { now_ += time; }
  // Whether a tick is due.
  bool is_behind() const;

  // ---- The CPU time of one call, of a worker that is another one each time ----
  double synchronize_with_two_grants();
  double renew();
  double deliver();
  double tick();
  // A failure is a defect of the scheduler, and ends the process.
  double check();
  double check_slice();

 private:
  struct BusyWorker {
    WorkerInfo info;
    std::vector<LeaseDescription> leases;
  };

  BusyWorker& next_worker();
  void deliver_all(BusyWorker& worker);
  double synchronize(BusyWorker& worker);
  static SubmitResult result_of(const BusyWorker& worker, const LeaseDescription& lease);

  Scheduler scheduler_{Options{}};
  Time now_{};
  int jobs_ = 0;
  std::vector<BusyWorker> workers_;
  std::size_t turn_ = 0;
  CheckCursor cursor_;
};

}  // namespace tessera::scheduler
