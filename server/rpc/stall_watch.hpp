// SPDX-License-Identifier: Apache-2.0
// Ends streams whose callers neither send nor read anything for long: such streams hold quota, memory and
// partial files that others wait for. Thread-safe.
#pragma once

#include <chrono>

#include "server/base/periodic.hpp"
#include "server/rpc/observer_list.hpp"

namespace tessera::rpc {

// A stream that is watched. It waits for its caller only.
class WatchedStream {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~WatchedStream() = default;
  // Ends the call if it has waited since this time or longer. Called under no lock of the watch, and must not
  // call the watch.
  virtual void end_if_waiting_since(Clock::time_point time) = 0;
};

class StallWatch {
 public:
  explicit StallWatch(std::chrono::milliseconds patience);

  void add(WatchedStream& stream) { streams_.add(stream); }
  // The stream is not called after this returns.
  void remove(WatchedStream& stream) { streams_.remove(stream); }

  std::chrono::milliseconds patience() const { return patience_; }

 private:
  void check();

  const std::chrono::milliseconds patience_;
  ObserverList<WatchedStream> streams_;
  base::Periodic checker_;
};

}  // namespace tessera::rpc
