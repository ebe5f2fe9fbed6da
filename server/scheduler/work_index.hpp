// SPDX-License-Identifier: Apache-2.0
// Which running jobs have work to lease, by its kind, each kind in the order in which jobs are served. Jobs
// without work, or with as many workers as they may have, are not found, so that a search skips only jobs
// that this one worker may not take. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <tuple>

#include "server/scheduler/job.hpp"
#include "server/scheduler/job_index.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/ranked_set.hpp"

namespace tessera::scheduler {

class WorkIndex {
 public:
  // Where a job belongs. A pure function of the job.
  struct Entry {
    // It has free samples; or only samples to audit; and leases that may be copied.
    std::optional<JobIndex::Place> free{}, audits{}, copies{};
    // It has free samples or samples to audit, but only for the workers that hold leases of it already.
    bool limited = false;
    bool operator==(const Entry&) const = default;
  };
  static Entry entry_for(const Job& job, const Producers& producers);

  // The job has changed.
  void update(const Job& job, const Producers& producers) { set(job.number(), entry_for(job, producers)); }
  void remove(JobNumber job) { set(job, {}); }
  // What update() or remove() has set.
  Entry entry_of(JobNumber job) const;

  const JobIndex& free() const { return free_; }
  const JobIndex& audits() const { return audits_; }
  const JobIndex& copies() const { return copies_; }
  bool is_limited(JobNumber job) const { return limited_.contains(job); }
  bool any_limited() const { return !limited_.empty(); }
  // Whether there is work for workers that hold nothing.
  bool any_open() const { return !free_.empty() || !audits_.empty() || !copies_.empty(); }

  // The jobs with free samples that are served before this one, as things stand; and those of them that have
  // a higher priority.
  std::size_t served_before(const Job& job) const;
  std::size_t of_higher_priority(const Job& job) const;

 private:
  // The order in which jobs are served while the virtual time stands still: the highest priority first, then
  // the earliest virtual finish, then the longest wait.
  using Rank = std::tuple<std::int64_t, double, std::uint64_t, JobNumber>;
  static Rank rank_of(JobNumber job, const JobIndex::Place& place);

  void set(JobNumber job, const Entry& entry);

  JobIndex free_, audits_, copies_;
  RankedSet<Rank> free_ranks_;  // of the jobs in free_
  std::set<JobNumber> limited_;
};

}  // namespace tessera::scheduler
