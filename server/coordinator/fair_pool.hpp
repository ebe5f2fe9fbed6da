// SPDX-License-Identifier: Apache-2.0
// A few threads for work that takes long, such as validating scenes: callers take turns, so that nobody waits
// for all that another has asked for, and none can fill the queue (fair_share.hpp). Thread-safe.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/coordinator/fair_share.hpp"

namespace tessera::coordinator {

class FairPool {
 public:
  // At most `max_waiting` tasks wait for one of the threads.
  FairPool(int threads, std::size_t max_waiting);
  // Runs what was posted to its end.
  ~FairPool();
  FairPool(const FairPool&) = delete;
  FairPool& operator=(const FairPool&) = delete;

  // False, and nothing happens, if the caller has its share of the waiting tasks already.
  [[nodiscard]] bool post(const std::string& caller, std::function<void()> task);
  // How many tasks of the caller wait.
  std::uint64_t waiting_of(const std::string& caller) const { return places_.held_by(caller); }

  // Tells tasks that wait that there is no time left for their work: each still runs, and asks.
  void close() { closed_ = true; }
  bool is_closed() const { return closed_; }

 private:
  struct Task {
    std::function<void()> work;
    FairShare::Held place;
  };
  void run();
  // The next task of the caller whose turn it is. There must be one.
  std::function<void()> take_next();

  FairShare places_;
  std::atomic<bool> closed_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::deque<Task>> waiting_;  // guarded by mutex_; by caller, nobody without a task
  std::deque<std::string> turns_;                    // guarded by mutex_; each of those callers once
  bool stopping_ = false;                            // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace tessera::coordinator
