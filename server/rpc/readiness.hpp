// SPDX-License-Identifier: Apache-2.0
// Whether a coordinator can take new work, and why not, for probes. It cannot while it stops, while the state
// lock is not available, or while its state cannot be written. Sentences name no files: probes need no
// credentials. Thread-safe.
#pragma once

#include <chrono>
#include <string>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"

namespace tessera::rpc {

class Readiness {
 public:
  using Clock = std::chrono::steady_clock;
  // It is not ready if nothing is noted for so long. A checkpoint may take many seconds.
  static constexpr std::chrono::seconds kLockWithin{5}, kStoreWithin{60};

  // The state lock was available.
  void note_lock(Clock::time_point now = Clock::now());
  // The state could be written, or not, for this reason.
  void note_store(std::string trouble, Clock::time_point now = Clock::now());
  // The coordinator stops.
  void note_stop();

  // UNAVAILABLE, with the reason.
  core::Status status(Clock::time_point now = Clock::now()) const;

 private:
  mutable core::Mutex mutex_;
  bool stops_ TESSERA_GUARDED_BY(mutex_) = false;
  std::string store_trouble_ TESSERA_GUARDED_BY(mutex_);
  Clock::time_point lock_at_ TESSERA_GUARDED_BY(mutex_) = Clock::now();
  Clock::time_point store_at_ TESSERA_GUARDED_BY(mutex_) = Clock::now();
};

}  // namespace tessera::rpc
