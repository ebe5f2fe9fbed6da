// SPDX-License-Identifier: Apache-2.0
// Runs delayed actions: one thread for the timers of a thousand simulated workers. Thread-safe.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <stop_token>
#include <thread>

namespace tessera::bench {

class Timeline {
 public:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;

  Timeline();
  // Actions that are not due yet are dropped.
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  // Actions that are due at the same time run in the order of registration. They must not block.
  void after(Seconds delay, std::function<void()> action);

 private:
  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::multimap<Clock::time_point, std::function<void()>> due_;  // guarded by mutex_
  std::jthread thread_;
};

}  // namespace tessera::bench
