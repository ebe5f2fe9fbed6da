// SPDX-License-Identifier: Apache-2.0
// Carries an exception out of an OpenMP region, which an exception must not leave. run() keeps the first
// exception, and rethrow() throws it after the region. Thread-safe.
#pragma once

#include <atomic>
#include <exception>
#include <mutex>

namespace tessera::core {

class ParallelErrors {
 public:
  // Calls `work`, unless an earlier call of any thread has failed.
  template <typename Work>
  void run(const Work& work) noexcept {
    if (failed()) return;
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!first_) first_ = std::current_exception();
      failed_.store(true, std::memory_order_relaxed);
    }
  }

  bool failed() const { return failed_.load(std::memory_order_relaxed); }

  // Throws the exception that run() has kept, if any. Call it after the region.
  void rethrow() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::exception_ptr first_;  // guarded by mutex_ inside the region
};

}  // namespace tessera::core
