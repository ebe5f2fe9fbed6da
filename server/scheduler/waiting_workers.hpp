// SPDX-License-Identifier: Apache-2.0
// The workers whose calls wait and that could be given more, in the order in which they are offered new work
// (WaitingRank). New work wakes them in waves, a few with each event, so that no event takes long because
// many wait. Not thread-safe.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/scheduler/worker_registry.hpp"

namespace tessera::scheduler {

class WaitingWorkers {
 public:
  // The worker's call waits, and is among those to wake if it could be given more.
  void hold(Worker& worker);
  // Its call waits no longer.
  void release(Worker& worker);
  // It is among those to wake.
  void enter(Worker& worker);
  // No change if it is not among them.
  void leave(Worker& worker);
  // Its rank may have changed.
  void update(Worker& worker);

  // Whether a worker that holds nothing is among them.
  bool any_idle() const { return !workers_.empty() && !workers_.begin()->first.holds_leases; }

  // There may be work for all of them. A wave in progress goes on, and another follows it.
  void begin_wave();
  bool in_wave() const { return in_wave_; }
  // The next ones of the wave, at most so many; none if there is no wave. It ends after the last worker.
  std::vector<WorkerId> next(int most);
  // There is nothing for workers that hold nothing, or for any.
  void skip_idle();
  void end_wave() { in_wave_ = again_ = false; }

 private:
  std::map<WaitingRank, WorkerId> workers_;
  bool in_wave_ = false, again_ = false;
  // The rank that the wave has reached.
  std::optional<WaitingRank> reached_;
};

}  // namespace tessera::scheduler
