// SPDX-License-Identifier: Apache-2.0
// The state of a farm as its scheduler knows it, and what the event in progress has done and may still do.
// The parts of the scheduler share it; nobody else changes it. Not thread-safe.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "server/scheduler/audit_waits.hpp"
#include "server/scheduler/events.hpp"
#include "server/scheduler/job.hpp"
#include "server/scheduler/options.hpp"
#include "server/scheduler/policy.hpp"
#include "server/scheduler/review_queue.hpp"
#include "server/scheduler/swept_map.hpp"
#include "server/scheduler/totals.hpp"
#include "server/scheduler/types.hpp"
#include "server/scheduler/unattended_audits.hpp"
#include "server/scheduler/waiting_workers.hpp"
#include "server/scheduler/work_index.hpp"
#include "server/scheduler/worker_registry.hpp"

namespace tessera::scheduler {

// During one event.
struct Step {
  // Whether there may be new work to lease, and whose leases have ended or shrunk.
  bool work_appeared = false;
  std::set<WorkerId> lost_leases{};
  // Those that may have to be named in Actions::progressed_jobs and progressed_workers.
  std::set<JobNumber> progressed_jobs{};
  std::set<WorkerId> progressed_workers{};
  // What the event may still do.
  WorkPerEvent left{};
};

struct FarmState {
  explicit FarmState(const Options& options);
  FarmState(const FarmState&) = delete;
  FarmState& operator=(const FarmState&) = delete;
  ~FarmState() = default;

  const Job* find(const JobId& id) const;
  // The job may change: it is entered in the indexes again before these are next used.
  Job* find(const JobId& id);
  Job& at(JobNumber number);
  // Complete, with nothing left to verify, and searched for samples of distrusted workers.
  bool settled(const Job& job) const { return job.settled() && !reviews.contains(job.number()); }
  // Changes when another worker might be an auditor.
  std::uint64_t workers_version() const { return 1 + registry.times_changed() + producers.times_changed(); }

  const Options options;
  Time now{};
  LeaseId last_lease_id;
  // The leases of all jobs: an id in use cannot be taken over a second time. Never iterated, so its order
  // does not matter.
  std::unordered_set<LeaseId, LeaseIdHash> live_leases;
  std::uint64_t servings = 0;
  // See JobSnapshot: where the latest lease began. Never decreases.
  double virtual_time = 0;

  std::map<JobNumber, Job> jobs;
  std::map<JobId, JobNumber> job_numbers;
  JobNumber last_job_number = 0;
  // The present run of each job. Never iterated, so its order does not matter.
  std::unordered_map<RunNumber, JobNumber> runs;
  RunNumber last_run_number = 0;
  // What workers still hold of runs that have ended.
  std::map<RunNumber, EndedRun> ended_runs;
  // Contains the jobs with strikes for a worker that was presumed dead; may contain others.
  SweptMap<WorkerId, std::set<JobNumber>> struck_jobs;

  WorkerRegistry registry;
  WaitingWorkers waiting;
  Producers producers;
  WorkIndex work;
  JobTotals job_totals;
  EventCounts counts;
  // Of all workers and jobs.
  RateMeter rate;
  AuditWaits audit_waits;
  UnattendedAudits unattended;
  ReviewQueue reviews;
  // Jobs that may have changed since they were last entered in work, job_totals, audit_waits and
  // unattended.
  std::set<JobNumber> touched;
  Step step;
};

}  // namespace tessera::scheduler
