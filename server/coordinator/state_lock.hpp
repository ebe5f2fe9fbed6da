// SPDX-License-Identifier: Apache-2.0
// The coordinator's state lock: holds the mutex, reads the clock once, and runs deferred callbacks after the
// mutex is released.
#pragma once

#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "server/coordinator/coordinator.hpp"

namespace tessera::coordinator {

class Coordinator::StateLock {
 public:
  explicit StateLock(Coordinator& coordinator)
      : lock_(coordinator.state_mutex_), now_(coordinator.options_.now()) {}
  ~StateLock() {
    lock_.unlock();
    for (const auto& action : later_) action();
  }
  StateLock(const StateLock&) = delete;
  StateLock& operator=(const StateLock&) = delete;

  scheduler::Time now() const { return now_; }
  // Runs the callback after the mutex is released.
  void later(std::function<void()> action) { later_.push_back(std::move(action)); }

 private:
  std::unique_lock<std::mutex> lock_;
  const scheduler::Time now_;
  std::vector<std::function<void()>> later_;
};

}  // namespace tessera::coordinator
