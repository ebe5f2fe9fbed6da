// SPDX-License-Identifier: Apache-2.0
// A thread pool for work that must not run in gRPC's callbacks: decompression, hashing, encoding, disk
// access. Thread-safe.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "core/base/mutex.hpp"

namespace tessera::base {

class ThreadPool {
 public:
  // At most `max_waiting` tasks wait for one of the threads.
  ThreadPool(int threads, std::size_t max_waiting);
  // Runs all posted tasks first.
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  // Returns false, and does nothing, if too many tasks wait already.
  [[nodiscard]] bool post(std::function<void()> task);
  // As post(), for short tasks. If nothing waits and no other task runs this way, the task runs on the
  // caller's thread, which costs less than to wake another. A task that throws ends the process on either
  // thread.
  [[nodiscard]] bool run_or_post(std::function<void()> task);

  // The number of tasks that wait for a thread.
  std::size_t waiting() const;

  // Marks the pool as closed. Waiting tasks still run, and check is_closed() to end early.
  void close() { closed_ = true; }
  bool is_closed() const { return closed_; }

 private:
  void run();

  const std::size_t max_waiting_;
  std::atomic<bool> closed_{false};
  std::atomic_flag runs_at_caller_;
  mutable core::Mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_ TESSERA_GUARDED_BY(mutex_);
  bool stopping_ TESSERA_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_;
};

}  // namespace tessera::base
