// SPDX-License-Identifier: Apache-2.0
// Calls a function periodically on its own thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <thread>

#include "core/base/mutex.hpp"

namespace tessera::base {

class Periodic {
 public:
  // Waits `period` before the first call, and between the end of one call and the start of the next.
  Periodic(std::chrono::milliseconds period, std::function<void()> call);
  // Waits for a call in progress.
  ~Periodic();
  // Shortens the wait for the next call to at most a quarter of the period.
  void trigger();
  Periodic(const Periodic&) = delete;
  Periodic& operator=(const Periodic&) = delete;

 private:
  const std::chrono::milliseconds period_;
  const std::function<void()> call_;
  core::Mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ TESSERA_GUARDED_BY(mutex_) = false;
  bool hurried_ TESSERA_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace tessera::base
