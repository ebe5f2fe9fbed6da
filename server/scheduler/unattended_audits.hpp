// SPDX-License-Identifier: Apache-2.0
// The jobs that lack nothing but samples to verify, which no worker holds: those that have waited for long
// are reported, each once. Not thread-safe.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

class UnattendedAudits {
 public:
  // The job is one of them, from now on or for longer.
  void enter(JobNumber job, Time now);
  // No change if it is not one of them.
  void leave(JobNumber job);
  bool contains(JobNumber job) const { return since_.contains(job); }

  // The first jobs that have been among them for so long and were not returned yet; at most so many.
  std::vector<JobNumber> take_due(Time now, Duration patience, std::size_t most);

 private:
  std::map<JobNumber, Time> since_;
  std::set<std::pair<Time, JobNumber>> unreported_;
};

}  // namespace tessera::scheduler
