// Ends streams whose callers neither send nor take anything for long: they hold places, memory and
// half-written files that others wait for. Thread-safe.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <set>

#include "server/coordinator/periodic.hpp"

namespace tessera::rpc {

// A stream that is watched. What it waits for is its caller.
class WatchedStream {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~WatchedStream() = default;
  // Ends the call if it has waited since this time or longer. Called under the watch's lock; must not block
  // and not call the watch.
  virtual void end_if_waiting_since(Clock::time_point time) = 0;
};

class StallWatch {
 public:
  explicit StallWatch(std::chrono::milliseconds patience);

  void add(WatchedStream& stream);
  // Afterwards it is not called any more.
  void remove(WatchedStream& stream);

  std::chrono::milliseconds patience() const { return patience_; }

 private:
  void look();

  const std::chrono::milliseconds patience_;
  std::mutex mutex_;
  std::set<WatchedStream*> streams_;  // guarded by mutex_
  coordinator::Periodic looker_;
};

}  // namespace tessera::rpc
