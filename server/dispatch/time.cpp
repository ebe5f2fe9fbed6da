// SPDX-License-Identifier: Apache-2.0
// The passing of time: what the coordinator does ten times a second, and once a second.
#include <string>
#include <vector>

#include "core/common/log.hpp"
#include "server/dispatch/dispatcher.hpp"

namespace tessera::dispatch {

using farm::StateLock;

namespace {

constexpr auto kCheckPeriod = std::chrono::seconds(1);

// Jobs, leases and workers that are checked in a second.
constexpr std::size_t kChecksAtOnce = 200;

// How many calls are answered under one hold of the state lock, which takes longer than to look at them.
constexpr std::size_t kAnsweredAtOnce = 16;

// Returns whether more may be due.
bool answer_due_calls(StateLock& lock) {
  const std::vector<std::string> due = lock->waiting.due(lock.now(), kAnsweredAtOnce);
  for (const std::string& worker : due) lock.apply(farm::top_up(lock, worker, true));
  return due.size() == kAnsweredAtOnce;
}

void answer_due_calls(farm::Farm& farm) {
  for (bool any_left = true; any_left;) {
    StateLock lock(farm);
    any_left = answer_due_calls(lock);
  }
}

}  // namespace

bool Dispatcher::tick() {
  advance_time();
  answer_due_calls(farm_);
  return StateLock(farm_)->checkpoint_is_awaited || film_memory_.is_scarce();
}

void Dispatcher::advance_time() {
  StateLock lock(farm_);
  lock.handle(scheduler::Tick{});
  if (lock.now() < next_check_) return;
  next_check_ = lock.now() + kCheckPeriod;
  lock.log_suppressed();
  if (const auto broken = lock->scheduler.check_some(check_cursor_, kChecksAtOnce))
    common::abort_with(*broken);
}

void Dispatcher::remove_gone(const std::string& worker) {
  StateLock lock(farm_);
  farm::refuse_if_gone(lock, worker);
}

void Dispatcher::close() {
  StateLock lock(farm_);
  lock->closed = true;
  while (lock->waiting.size() > 0) {
    const std::string worker = lock->waiting.all().begin()->first;
    farm::refuse(lock, lock->waiting.take(worker).caller,
                 {core::ErrorCode::kUnavailable, "the coordinator is stopping: try again"});
  }
}

}  // namespace tessera::dispatch
