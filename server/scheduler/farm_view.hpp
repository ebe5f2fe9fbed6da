// SPDX-License-Identifier: Apache-2.0
// What a scheduler can be asked about its farm. Not thread-safe; the calls are short.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/views.hpp"

namespace tessera::scheduler {

enum class CheckDepth {
  kCounters,    // linear in jobs, workers and leases
  kEverySample  // also in tiles, and in workers times jobs: for tests
};

// Where check_some() goes on: with this job or a later one, or with its leases of either kind after this one;
// or with this worker or a later one.
struct CheckCursor {
  enum class Of { kJobs, kLeases, kAudits, kWorkers } of = Of::kJobs;
  JobNumber job = 0;
  LeaseId lease;
  WorkerId worker;
  // How often everything has been checked.
  std::uint64_t rounds = 0;
};

class FarmView {
 public:
  // When the next lease expires, worker is forgotten or wait for an auditor ends: handle(Tick{}, …) is due
  // then. Not after the present if something is left to be done that would take a single event too long.
  // Absent: never.
  std::optional<Time> next_deadline() const;

  // Speeds are those at `now`.
  std::optional<JobView> job(const JobId& id, Time now) const;
  // In the order of submission.
  std::vector<JobView> jobs(Time now) const;
  // Jobs whose ids begin with the prefix; at most the latest `most`. The time is proportional to these alone.
  std::vector<JobView> jobs(Time now, std::string_view id_prefix, std::size_t most) const;
  // In the order of ids.
  std::vector<WorkerView> workers(Time now) const;
  bool has_worker(const WorkerId& id) const { return farm_.registry.find(id) != nullptr; }
  // Those after this id, at most so many.
  std::vector<WorkerView> workers(Time now, const WorkerId& after, std::size_t most) const;
  // Empty if it is unknown or forgotten.
  std::optional<WorkerView> worker(const WorkerId& id, Time now) const;
  // What the worker last said of itself; null if it is unknown or forgotten. Valid until the next handle().
  const WorkerInfo* worker_info(const WorkerId& id) const;

  // The tiles of the next leases of missing samples after this one, at most so many leases; none if there is
  // no such job.
  LeasePage leased_tiles(const JobId& id, const LeaseId& after, std::size_t most) const;

  // Takes no time that depends on the number of jobs and workers.
  Totals totals(Time now) const;

  // The samples of one tile that are done, for checkpoints. The job must exist and have the tile. Valid until
  // the next handle().
  const IntervalSet& done(const JobId& id, int tile) const;

  // The producers of one tile's samples that nobody has confirmed; for checkpoints, with done().
  std::vector<ProducedItem> provenance(const JobId& id, int tile) const;

  // The first violated invariant as a sentence; empty if there is none. A violation is a defect of the
  // scheduler.
  std::optional<std::string> check_invariants(CheckDepth depth) const;
  // The same for the next jobs, leases and workers, at most so many, at the depth kCounters but for sums over
  // all of them, or until all are checked. Takes a few microseconds for each. Other events may be handled
  // between two calls.
  std::optional<std::string> check_some(CheckCursor& cursor, std::size_t most) const;

 protected:
  explicit FarmView(const Options& options) : farm_(options) {}
  FarmView(const FarmView&) = delete;
  FarmView& operator=(const FarmView&) = delete;
  ~FarmView() = default;

  FarmState farm_;

 private:
  JobView job_view(const Job& job, Time now) const;
  Waiting waiting_of(const Job& job) const;
  WorkerView worker_view(const Worker& worker, Time now) const;
  std::vector<CooldownView> cooldowns_of(const Worker& worker, Time now) const;
};

}  // namespace tessera::scheduler
