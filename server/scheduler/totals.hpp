// SPDX-License-Identifier: Apache-2.0
// Sums over all jobs and workers, and counts of what has happened, for those who watch a farm. The scheduler
// keeps them with each event, so that reading them takes no time that depends on the size of the farm.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "server/scheduler/job.hpp"
#include "server/scheduler/job_state.hpp"
#include "server/scheduler/lease_state.hpp"
#include "server/scheduler/types.hpp"
#include "server/scheduler/worker_state.hpp"

namespace tessera::scheduler {

// Since the scheduler was created.
struct EventCounts {
  // Pixel samples that were accepted.
  std::uint64_t accepted_samples = 0;
  // Items of results by their verdict.
  std::uint64_t accepted_items = 0, audited_items = 0, dropped_items = 0;
  // Leases that were given, and leases of an earlier run or a lost worker that were taken over.
  std::uint64_t granted_leases = 0, adopted_leases = 0;
  // Changes of jobs, by the new state; without new jobs.
  std::array<std::uint64_t, kJobStates> job_changes{};
  // Leases by the state in which they ended.
  std::array<std::uint64_t, kLeaseStates> ended_leases{};

  bool operator==(const EventCounts&) const = default;
};

struct Totals {
  std::array<std::uint64_t, kJobStates> jobs{};
  std::array<std::uint64_t, kWorkerActivities> workers{};
  // What running jobs lack, and what of them must be rendered again for an audit, in pixel samples.
  std::uint64_t missing_samples = 0, samples_to_verify = 0;
  // Accepted samples over the last seconds; 0 if unknown.
  double samples_per_second = 0;
  EventCounts counts;
};

// The sums over jobs. Not thread-safe.
class JobTotals {
 public:
  // What one job contributes. A pure function of the job.
  struct Share {
    JobState state = JobState::kRunning;
    std::uint64_t missing_samples = 0, samples_to_verify = 0;
    bool operator==(const Share&) const = default;
  };
  static Share share_of(const Job& job);

  // The job is new or has changed.
  void update(const Job& job);
  void remove(JobNumber job);

  bool counts(JobNumber job, const Share& share) const;
  // Fills in the part of the totals that concerns jobs.
  void write_to(Totals& totals) const;

 private:
  void add(const Share& share);
  void subtract(const Share& share);

  // Never iterated, so its order does not matter.
  std::unordered_map<JobNumber, Share> shares_;
  std::array<std::uint64_t, kJobStates> jobs_{};
  std::uint64_t missing_samples_ = 0, samples_to_verify_ = 0;
};

}  // namespace tessera::scheduler
