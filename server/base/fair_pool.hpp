// SPDX-License-Identifier: Apache-2.0
// A thread pool for long tasks, such as validating scenes. Callers are served round-robin, so that nobody
// waits for all tasks of another caller, and none can fill the queue (fair_share.hpp). Thread-safe.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/mutex.hpp"
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
  std::function<void()> take_next() TESSERA_REQUIRES(mutex_);

  FairShare places_;
  std::atomic<bool> closed_{false};
  core::Mutex mutex_;
  std::condition_variable changed_;
  // By caller, without empty entries.
  std::map<std::string, std::deque<Task>> waiting_ TESSERA_GUARDED_BY(mutex_);
  std::deque<std::string> turns_ TESSERA_GUARDED_BY(mutex_);  // each of these callers once
  bool stopping_ TESSERA_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_;
};

}  // namespace tessera::base
