// SPDX-License-Identifier: Apache-2.0
// Does things later: one thread for the clocks of a thousand simulated workers. Thread-safe.
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
  // What is not due yet is never done.
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  // What is due at one moment is done in the order of its entry. Must not block.
  void after(Seconds delay, std::function<void()> action);

 private:
  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::multimap<Clock::time_point, std::function<void()>> due_;  // guarded by mutex_
  std::jthread thread_;
};

}  // namespace tessera::bench
