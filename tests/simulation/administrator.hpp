// SPDX-License-Identifier: Apache-2.0
// What happens around the scheduler in some rough farms: workers are drained or stopped, the quarantine is
// lifted, films have no memory for a while, the store loses tiles, and finished jobs leave the scheduler.
// Uses a random generator of its own, so that the other farms stay the same.
#pragma once

#include <cstdint>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

class Administrator {
 public:
  Administrator(World& world, Coordinator& coordinator, std::uint64_t seed)
      : world_(world), coordinator_(coordinator), random_(seed ^ 0xad317) {}

  // Schedules what happens in the first so many seconds, and what never ends. Jobs whose samples are audited
  // stay in the scheduler, and lose no tiles.
  void begin(double unrest_seconds, bool audited);
  // The workers that were drained may take leases again.
  void calm_down();
  // How much later the farm may be done.
  double delay_seconds() const { return delay_seconds_; }
  // How often workers that deliver wrong samples may have been let in again.
  int lifts() const { return lifts_; }

 private:
  void drain();
  void lift();
  void lose_tile();
  void release();

  World& world_;
  Coordinator& coordinator_;
  Random random_;
  double delay_seconds_ = 0;
  int lifts_ = 0;
  bool calm_ = false;
};

}  // namespace tessera::simulation
