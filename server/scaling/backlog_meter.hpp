// SPDX-License-Identifier: Apache-2.0
// Measures how long one worker would take for everything that the jobs of a farm lack. Unlike the time that
// the whole farm needs, this does not depend on the number of workers, so that it can be divided by the time
// that one worker should have to do. Not thread-safe.
#pragma once

#include <chrono>

#include "server/farm/totals.hpp"

namespace tessera::scaling {

struct Backlog {
  // A job waits to be validated or lacks samples.
  bool has_work = false;
  // Seconds of work for one worker. At least 1 if there is work, also while no speed is known: one worker
  // will tell. 0 if there is none.
  double worker_seconds = 0;

  bool operator==(const Backlog&) const = default;
};

class BacklogMeter {
 public:
  using Clock = std::chrono::steady_clock;

  // To be called every few seconds: it averages the speed of a worker over about half a minute.
  Backlog measure(const farm::Totals& totals, Clock::time_point now);

 private:
  void note_speed(const scheduler::Totals& totals, Clock::time_point now);

  double samples_per_worker_second_ = 0;  // 0: not known yet
  Clock::time_point noted_at_{};
};

}  // namespace tessera::scaling
