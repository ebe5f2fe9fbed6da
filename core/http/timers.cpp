// SPDX-License-Identifier: Apache-2.0
#include "core/http/timers.hpp"

#include <utility>

namespace tessera::http {

Timers::Timers() : thread_([this] { run(); }) {}

Timers::~Timers() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void Timers::set(Id id, Clock::time_point time, std::function<void()> call) {
  bool is_first = false;
  {
    const std::lock_guard lock(mutex_);
    if (const auto old = by_id_.find(id); old != by_id_.end()) calls_.erase(old->second);
    const auto added = calls_.emplace(time, std::pair(id, std::move(call)));
    by_id_[id] = added;
    is_first = added == calls_.begin();
  }
  if (is_first) changed_.notify_one();
}

void Timers::clear(Id id) {
  const std::lock_guard lock(mutex_);
  const auto found = by_id_.find(id);
  if (found == by_id_.end()) return;
  calls_.erase(found->second);
  by_id_.erase(found);
}

void Timers::run() {
  std::unique_lock lock(mutex_);
  while (!is_over_) {
    if (calls_.empty()) {
      changed_.wait(lock);
      continue;
    }
    const auto first = calls_.begin();
    const Clock::time_point time = first->first;
    if (time > Clock::now()) {
      changed_.wait_until(lock, time);
      continue;
    }
    const auto call = std::move(first->second.second);
    by_id_.erase(first->second.first);
    calls_.erase(first);
    lock.unlock();
    call();
    lock.lock();
  }
}

}  // namespace tessera::http
