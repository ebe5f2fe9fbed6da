// SPDX-License-Identifier: Apache-2.0
// The state of a farm as its scheduler knows it: what it can be asked, who may be given which work, and which
// work comes first. Only the scheduler changes it. Not thread-safe; the calls are short.
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
#include "server/scheduler/views.hpp"
#include "server/scheduler/waiting_workers.hpp"
#include "server/scheduler/work_index.hpp"
#include "server/scheduler/worker_registry.hpp"

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

class FarmState {
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
  bool has_worker(const WorkerId& id) const { return registry_.find(id) != nullptr; }
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
  explicit FarmState(const Options& options);
  FarmState(const FarmState&) = delete;
  FarmState& operator=(const FarmState&) = delete;
  ~FarmState() = default;

  const Job* find(const JobId& id) const;
  // Complete, with nothing left to verify, and searched for samples of distrusted workers.
  bool settled(const Job& job) const { return job.settled() && !reviews_.contains(job.number()); }

  // ---- Which work a worker may be given, and which of it comes first (eligibility.cpp) ----
  // Whether its samples can count for the job.
  static bool can_render(const Worker& worker, const Job& job);
  // Whether the worker may be given leases of the job, whatever work there is.
  bool may_take(const Worker& worker, const Job& job) const;
  bool can_be_given(const Worker& worker, const Job& job, bool also_refused) const;
  bool can_audit(const Job& job, const Worker& worker) const;
  // An audit that another worker has in progress; empty if this worker may not do it.
  Portion audit_copy(const Job& job, const Worker& worker) const;
  std::vector<JobSnapshot> snapshots(const std::vector<JobNumber>& jobs) const;
  // The job of which the worker is given its next lease, as far as the indexes are up to date.
  std::optional<JobNumber> chosen(const Worker& worker, bool also_refused) const;
  // The number of workers that share the job's work.
  int sharers(const Job& job) const;
  // The expected time for all samples that it holds.
  double expected_seconds(const Worker& worker) const;

  // ---- Which workers could audit a job that lacks nothing else (auditors.cpp) ----
  // Whether the job lacks nothing but audits that were chosen by lot.
  static bool lacks_only_lots(const Job& job);
  std::optional<WorkerId> find_auditor(const Job& job) const;
  // Changes when another worker might be an auditor.
  std::uint64_t workers_version() const { return 1 + registry_.times_changed() + producers_.times_changed(); }

  // ---- What fails a job (farm_state.cpp) ----
  // Look at the workers that could render the job and would report it if they cannot.
  AreAll are_all_names(const Job& job) const;
  AreAll are_all_principals(const Job& job) const;

  const Options options_;
  Time now_{};
  LeaseId last_lease_id_;
  // The leases of all jobs: an id in use cannot be taken over a second time. Never iterated, so its order
  // does not matter.
  std::unordered_set<LeaseId, LeaseIdHash> live_leases_;
  std::uint64_t servings_ = 0;
  // See JobSnapshot: where the latest lease began. Never decreases.
  double virtual_time_ = 0;

  std::map<JobNumber, Job> jobs_;
  std::map<JobId, JobNumber> job_numbers_;
  JobNumber last_job_number_ = 0;
  // The present run of each job. Never iterated, so its order does not matter.
  std::unordered_map<RunNumber, JobNumber> runs_;
  RunNumber last_run_number_ = 0;
  // What workers still hold of runs that have ended.
  std::map<RunNumber, EndedRun> ended_runs_;
  // Contains the jobs with strikes for a worker that was presumed dead; may contain others.
  SweptMap<WorkerId, std::set<JobNumber>> struck_jobs_;

  WorkerRegistry registry_;
  WaitingWorkers waiting_;
  Producers producers_;
  WorkIndex work_;
  JobTotals job_totals_;
  EventCounts counts_;
  // Of all workers and jobs.
  RateMeter rate_;
  AuditWaits audit_waits_;
  ReviewQueue reviews_;
  // Jobs that may have changed since they were last entered in work_, job_totals_ and audit_waits_.
  std::set<JobNumber> touched_;
  // What the present event may still do.
  WorkPerEvent left_;

 private:
  friend class Invariants;

  // The worker is given none since they stalled and it fetches the files.
  static bool awaits_files(const Worker& worker, const Job& job);
  // The worker has reported within lease_duration that it cannot build the scene.
  bool has_refused_lately(const Worker& worker, const Job& job) const;
  static bool is_no_help(const Job& job, const Worker& worker);
  std::optional<WorkerId> find_auditor_at_work(const Job& job) const;
  std::optional<WorkerId> find_auditor_among(const Job& job, const std::set<WorkerId>& workers) const;
  bool would_audit(const Job& job, const WorkerId& worker) const;
  // The stalled workers among those that could otherwise be counted, by a part of their description.
  std::map<std::string, int> stalled_by(const Job& job, std::string WorkerInfo::*part) const;

  JobView job_view(const Job& job, Time now) const;
  Waiting waiting_of(const Job& job) const;
  WorkerView worker_view(const Worker& worker, Time now) const;
  std::vector<CooldownView> cooldowns_of(const Worker& worker, Time now) const;
};

}  // namespace tessera::scheduler
