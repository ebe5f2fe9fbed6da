// SPDX-License-Identifier: Apache-2.0
// The jobs that lack nothing but audits that were chosen by lot: whether there is a worker that could do
// them, and since when there is none. Each is looked at again when it or the workers have changed, a few jobs
// with each event. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

class AuditWaits {
 public:
  explicit AuditWaits(Duration patience) : patience_(patience) {}

  // The job is one of them, and has changed.
  void enter(JobNumber job);
  // No change if it is not one of them.
  void leave(JobNumber job);

  // A job that was last looked at before this version of the workers. Versions are numbers from 1.
  std::optional<JobNumber> next_outdated(std::uint64_t version) const;
  // The outcome of a look: a worker that could audit, or none.
  void looked_at(JobNumber job, std::uint64_t version, const std::optional<WorkerId>& auditor, Time now);
  bool contains(JobNumber job) const { return waits_.contains(job); }
  // The worker that could audit at the last look that found one.
  const WorkerId& last_auditor(JobNumber job) const { return waits_.at(job).auditor; }

  // The first jobs that have had no auditor for all of the patience; at most so many.
  std::vector<JobNumber> due(Time now, std::size_t most) const;
  bool is_due(JobNumber job, Time now) const;
  std::optional<Time> next_deadline() const;

 private:
  struct Wait {
    std::uint64_t version = 0;
    WorkerId auditor;
    // Since when there is no auditor.
    std::optional<Time> since;
  };

  void set_version(JobNumber job, Wait& wait, std::uint64_t version);
  void set_since(JobNumber job, Wait& wait, std::optional<Time> since);

  const Duration patience_;
  std::map<JobNumber, Wait> waits_;
  std::set<std::pair<std::uint64_t, JobNumber>> by_version_;
  std::set<std::pair<Time, JobNumber>> by_deadline_;
};

}  // namespace tessera::scheduler
