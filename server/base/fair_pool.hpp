// SPDX-License-Identifier: Apache-2.0
// A thread pool for long tasks, such as validating scenes. Callers are served round-robin, so that nobody
// waits for all tasks of another caller, and none can fill the queue (fair_share.hpp). Thread-safe.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/base/fair_share.hpp"

namespace tessera::base {

class FairPool {
 public:
  // At most `max_waiting` tasks wait for one of the threads.
  FairPool(int threads, std::size_t max_waiting);
  // Runs all posted tasks first.
  ~FairPool();
  FairPool(const FairPool&) = delete;
  FairPool& operator=(const FairPool&) = delete;

  // Returns false, and does nothing, if the caller's share of waiting tasks is used up.
  [[nodiscard]] bool post(const std::string& caller, std::function<void()> task);
  // A place among the waiting tasks, for a task that is posted later. Empty if the caller's share is used up.
  [[nodiscard]] std::optional<FairShare::Held> reserve(const std::string& caller) {
    return places_.take(caller);
  }
  void post(const std::string& caller, FairShare::Held place, std::function<void()> task);
  // The number of waiting tasks of all callers, and of the caller, with reserved places.
  std::uint64_t waiting() const { return places_.held(); }
  std::uint64_t waiting_of(const std::string& caller) const { return places_.held_by(caller); }

  // Marks the pool as closed. Waiting tasks still run, and check is_closed() to end early.
  void close() { closed_ = true; }
  bool is_closed() const { return closed_; }

 private:
  struct Task {
    std::function<void()> work;
    FairShare::Held place;
  };
  void run();
  // Removes the next task, of the caller at the head of turns_. There must be one.
  std::function<void()> take_next();

  FairShare places_;
  std::atomic<bool> closed_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::deque<Task>> waiting_;  // guarded by mutex_; by caller, without empty entries
  std::deque<std::string> turns_;                    // guarded by mutex_; each of these callers once
  bool stopping_ = false;                            // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace tessera::base
