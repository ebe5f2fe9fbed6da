// SPDX-License-Identifier: Apache-2.0
// A few threads for work that must not be done in gRPC's callbacks: decompressing, hashing, encoding, disks.
// Thread-safe.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace tessera::coordinator {

class ThreadPool {
 public:
  // At most `max_waiting` tasks wait for one of the threads.
  ThreadPool(int threads, std::size_t max_waiting);
  // Runs what was posted to its end.
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  // False, and nothing happens, if too many tasks are waiting already.
  [[nodiscard]] bool post(std::function<void()> task);
  // The same for a task that is short: to run it on the caller's thread costs less than to wake another. That
  // is done with one at a time, while nothing waits. A task that throws ends the process on either thread.
  [[nodiscard]] bool run_or_post(std::function<void()> task);

  // Tells tasks that wait that there is no time left for their work: each still runs, and asks.
  void close() { closed_ = true; }
  bool is_closed() const { return closed_; }

 private:
  bool is_idle();
  void run();

  const std::size_t max_waiting_;
  std::atomic<bool> closed_{false};
  std::atomic_flag runs_at_caller_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;  // guarded by mutex_
  bool stopping_ = false;                      // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace tessera::coordinator
