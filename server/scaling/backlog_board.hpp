// SPDX-License-Identifier: Apache-2.0
// The last measured backlog, for calls that read it and calls that wait for changes. Thread-safe.
#pragma once

#include <chrono>
#include <condition_variable>
#include "core/base/mutex.hpp"

#include "server/scaling/backlog_meter.hpp"

namespace tessera::scaling {

class BacklogBoard {
 public:
  void publish(const Backlog& backlog);
  Backlog latest() const;
  // Ends all waits; later ones return at once.
  void close();
  bool is_closed() const;
  // Blocks until the farm begins or stops to have work, unlike `has_work`, until close(), or so long.
  void wait_for_change(bool has_work, std::chrono::milliseconds longest);

 private:
  mutable core::Mutex mutex_;
  std::condition_variable changed_;
  Backlog backlog_ TESSERA_GUARDED_BY(mutex_);
  bool closed_ TESSERA_GUARDED_BY(mutex_) = false;
};

}  // namespace tessera::scaling
