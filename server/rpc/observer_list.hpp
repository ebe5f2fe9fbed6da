// SPDX-License-Identifier: Apache-2.0
// A list of observers that are called periodically, one after the other and under no lock, so that a slow
// observer delays nobody who is added or removed. Thread-safe.
#pragma once

#include <condition_variable>
#include <mutex>
#include <set>

namespace tessera::rpc {

template <typename Observer>
class ObserverList {
 public:
  void add(Observer& observer) {
    const std::lock_guard lock(mutex_);
    observers_.insert(&observer);
  }
  // The observer is not called after this returns. Waits for a call of it in progress, which must not be the
  // caller's own.
  void remove(Observer& observer) {
    std::unique_lock lock(mutex_);
    observers_.erase(&observer);
    returned_.wait(lock, [&] { return called_ != &observer; });
  }
  // Calls each observer that stays in the list. Waits for another round in progress.
  template <typename Call>
  void for_each(const Call& call) {
    const std::lock_guard one_at_a_time(round_mutex_);
    std::unique_lock lock(mutex_);
    for (auto next = observers_.begin(); next != observers_.end();) {
      Observer* const called = called_ = *next;
      lock.unlock();
      call(*called);
      lock.lock();
      called_ = nullptr;
      returned_.notify_all();
      next = observers_.upper_bound(called);
    }
  }

 private:
  std::mutex round_mutex_;
  std::mutex mutex_;
  std::condition_variable returned_;
  std::set<Observer*> observers_;  // guarded by mutex_
  Observer* called_ = nullptr;     // guarded by mutex_
};

}  // namespace tessera::rpc
