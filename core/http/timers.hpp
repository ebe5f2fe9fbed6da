// SPDX-License-Identifier: Apache-2.0
// Calls functions at given times, on one thread for all. Thread-safe.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

namespace tessera::http {

class Timers {
 public:
  using Clock = std::chrono::steady_clock;
  using Id = const void*;

  Timers();
  ~Timers();
  Timers(const Timers&) = delete;
  Timers& operator=(const Timers&) = delete;

  // Calls the function, which must return soon, at this time. Replaces what was set for this id.
  void set(Id id, Clock::time_point time, std::function<void()> call);
  // A call that is under way may still happen.
  void clear(Id id);

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  bool is_over_ = false;
  std::multimap<Clock::time_point, std::pair<Id, std::function<void()>>> calls_;
  std::map<Id, decltype(calls_)::iterator> by_id_;

  std::thread thread_;
};

}  // namespace tessera::http
