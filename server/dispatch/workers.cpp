// SPDX-License-Identifier: Apache-2.0
// The list of workers.
#include <chrono>

#include "server/base/wall_clock.hpp"
#include "server/dispatch/dispatcher.hpp"
#include "server/farm/wire.hpp"

namespace tessera::dispatch {

using farm::StateLock;

namespace {

// What a worker's entry is made of, copied under the state lock.
struct WorkerSnapshot {
  scheduler::WorkerView view;
  std::uint64_t rejected_results = 0;
  std::vector<std::string> troubles;
  std::string quarantined_because;  // empty unless it is quarantined
};

WorkerSnapshot snapshot_of(const StateLock& lock, scheduler::WorkerView view) {
  const std::string& id = view.info.id.value;
  WorkerSnapshot snapshot{{}, lock->quarantine.refusals(id), lock->troubles.of_worker(id), {}};
  if (lock->quarantine.is_quarantined(id))
    snapshot.quarantined_because = lock->quarantine.because(id, view.info.machine);
  snapshot.view = std::move(view);
  return snapshot;
}

v1::ListWorkersResponse::Worker to_wire(const WorkerSnapshot& snapshot, scheduler::Time now) {
  const auto silent = std::chrono::duration_cast<std::chrono::milliseconds>(now - snapshot.view.last_seen);
  auto worker = farm::to_wire(snapshot.view, base::wall_clock_ms() - silent.count());
  worker.set_rejected_results(snapshot.rejected_results);
  worker.mutable_troubles()->Add(snapshot.troubles.begin(), snapshot.troubles.end());
  if (snapshot.quarantined_because.empty()) return worker;
  worker.set_quarantined(true);
  worker.set_quarantine_reason(snapshot.quarantined_because);
  return worker;
}

}  // namespace

std::vector<v1::ListWorkersResponse::Worker> Dispatcher::workers() {
  std::vector<WorkerSnapshot> snapshots;
  scheduler::Time now;
  {
    const StateLock lock(farm_);
    now = lock.now();
    for (scheduler::WorkerView& view : lock->scheduler.workers(now))
      snapshots.push_back(snapshot_of(lock, std::move(view)));
  }
  std::vector<v1::ListWorkersResponse::Worker> result;
  for (const WorkerSnapshot& snapshot : snapshots) result.push_back(to_wire(snapshot, now));
  return result;
}

}  // namespace tessera::dispatch
