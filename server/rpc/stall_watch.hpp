// SPDX-License-Identifier: Apache-2.0
// Ends streams whose callers neither send nor take anything for long: they hold places, memory and
// half-written files that others wait for. Thread-safe.
#pragma once

#include <chrono>

#include "server/coordinator/periodic.hpp"
#include "server/rpc/observer_list.hpp"

namespace tessera::rpc {

// A stream that is watched. What it waits for is its caller.
class WatchedStream {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~WatchedStream() = default;
  // Ends the call if it has waited since this time or longer. Called under no lock of the watch; must not
  // call it.
  virtual void end_if_waiting_since(Clock::time_point time) = 0;
};

class StallWatch {
 public:
  explicit StallWatch(std::chrono::milliseconds patience);

  void add(WatchedStream& stream) { streams_.add(stream); }
  // Afterwards it is not called any more.
  void remove(WatchedStream& stream) { streams_.remove(stream); }

  std::chrono::milliseconds patience() const { return patience_; }

 private:
  void check();

  const std::chrono::milliseconds patience_;
  ObserverList<WatchedStream> streams_;
  coordinator::Periodic checker_;
};

}  // namespace tessera::rpc
