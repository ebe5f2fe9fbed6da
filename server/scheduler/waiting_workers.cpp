// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/waiting_workers.hpp"

#include <algorithm>

namespace tessera::scheduler {

void WaitingWorkers::enter(Worker& worker) {
  leave(worker);
  worker.waiting_rank = worker.rank();
  workers_.emplace(*worker.waiting_rank, worker.info.id);
}

void WaitingWorkers::hold(Worker& worker) {
  worker.waiting = true;
  if (worker.room() > 0) {
    enter(worker);
  } else {
    leave(worker);
  }
}

void WaitingWorkers::release(Worker& worker) {
  worker.waiting = false;
  leave(worker);
}

void WaitingWorkers::leave(Worker& worker) {
  if (worker.waiting_rank) workers_.erase(*worker.waiting_rank);
  worker.waiting_rank.reset();
}

void WaitingWorkers::update(Worker& worker) {
  if (worker.waiting_rank && *worker.waiting_rank != worker.rank()) enter(worker);
}

void WaitingWorkers::begin_wave() {
  again_ = in_wave_;
  if (in_wave_) return;
  in_wave_ = true;
  reached_.reset();
}

std::vector<WorkerId> WaitingWorkers::next(int most) {
  std::vector<WorkerId> woken;
  if (!in_wave_) return woken;
  auto next = reached_ ? workers_.upper_bound(*reached_) : workers_.begin();
  for (; next != workers_.end() && most > 0; ++next, --most) {
    woken.push_back(next->second);
    reached_ = next->first;
  }
  if (next != workers_.end()) return woken;
  in_wave_ = std::exchange(again_, false);
  reached_.reset();
  return woken;
}

void WaitingWorkers::skip_idle() {
  const WaitingRank first_busy{.holds_leases = true, .last_refusal = Time::min(), .sequence = 0};
  reached_ = std::max(reached_.value_or(first_busy), first_busy);
}

}  // namespace tessera::scheduler
