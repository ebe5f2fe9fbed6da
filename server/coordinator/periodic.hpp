// SPDX-License-Identifier: Apache-2.0
// Calls a function again and again from a thread of its own.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace tessera::coordinator {

class Periodic {
 public:
  // Waits `period` between the end of one call and the begin of the next; the first comes after one period.
  Periodic(std::chrono::milliseconds period, std::function<void()> call);
  // Waits for a call that is under way.
  ~Periodic();
  // The next call need not wait for longer than a quarter of the period.
  void trigger();
  Periodic(const Periodic&) = delete;
  Periodic& operator=(const Periodic&) = delete;

 private:
  const std::chrono::milliseconds period_;
  const std::function<void()> call_;
  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  bool stopping_ = false;
  bool hurried_ = false;
  std::thread thread_;
};

}  // namespace tessera::coordinator
