// SPDX-License-Identifier: Apache-2.0
// A list of observers that are called periodically, one after the other and under no lock, so that a slow
// observer delays nobody who is added or removed. Thread-safe.
#pragma once

#include <condition_variable>
#include <set>

#include "core/base/mutex.hpp"

namespace tessera::rpc {

template <typename Observer>
class ObserverList {
 public:
  void add(Observer& observer) {
    const core::MutexLock lock(mutex_);
    observers_.insert(&observer);
  }
  // The observer is not called after this returns. Waits for a call of it in progress, which must not be the
  // caller's own.
  void remove(Observer& observer) {
    core::MutexLock lock(mutex_);
    observers_.erase(&observer);
    returned_.wait(lock.native(), [&]() TESSERA_REQUIRES(mutex_) { return called_ != &observer; });
  }
  // Calls each observer that stays in the list. Waits for another round in progress.
  template <typename Call>
  void for_each(const Call& call) {
    const core::MutexLock one_at_a_time(round_mutex_);
    core::MutexLock lock(mutex_);
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
  core::Mutex round_mutex_;
  core::Mutex mutex_;
  std::condition_variable returned_;
  std::set<Observer*> observers_ TESSERA_GUARDED_BY(mutex_);
  Observer* called_ TESSERA_GUARDED_BY(mutex_) = nullptr;
};

}  // namespace tessera::rpc
