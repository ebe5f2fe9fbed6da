// SPDX-License-Identifier: Apache-2.0
// The farm's scheduler decides which worker renders which samples of which job.
//
// It is a deterministic state machine. handle() takes an event and its time, and returns the actions that
// follow; nothing else changes the state. It has no threads, no I/O, no clock and no randomness, and knows
// nothing of RPC, storage or pixels. Its caller serialises the calls, adds accepted results to the film,
// stores what must be durable, and calls handle(Tick) at next_deadline(). Not thread-safe; the calls are
// short.
//
// Invariants (check_invariants):
// - A sample of a running or paused job is done, leased to at most two workers, or free.
// - A range is accepted only if all of its samples are missing, so none is counted twice.
// - A done job lacks nothing.
// - No more workers hold leases of a job than its limit allows, or held some when the limit was lowered.
// - Leases are held by known workers that synchronised within lease_duration, and that delivered something of
//   the job within patience() (policy.hpp), or tried to (DeferResult).
// - A worker that waits, holds nothing and wants a lease waits because there is none to give.
// - Samples that are due for an audit are rendered again by a worker of another name, and their job is not
//   done before.
// - Samples of which a worker may have died, or in which one is stuck, are leased to workers that hold
//   nothing else. After three consecutive losses of workers with different names their job fails, so that it
//   does not take down the farm.
// - A worker that is stuck holds nothing.
//
// After a restart, hand in RestoreJob for each stored job, in the order of submission, with a higher epoch.
// Workers then report leases that this scheduler did not grant; it takes them over where their samples are
// still missing. Samples that were accepted after the last checkpoint are missing again, and are rendered
// again.
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

// How much a single event does at most of what can wait, so that none takes long because a farm is large.
// What is left is done with the next events, and does not change what each worker is told.
struct WorkPerEvent {
  // Silent workers that lose their leases or are forgotten, and waiting workers that are woken by new work.
  int expired_workers = 64, woken_workers = 16;
  // Leases of jobs that have ended.
  int revoked_leases = 64;
  // Tiles that are searched for samples of distrusted workers, and audits that are given up.
  int searched_tiles = 4096, waived_audits = 1024;
  // Jobs for which an auditor is sought.
  int unaudited_jobs = 32;
};

struct Options {
  // Identifies this run of the coordinator; must be higher than that of all earlier runs. 24 bits.
  std::uint32_t epoch = 1;
  // The heartbeat timeout: a worker that has not synchronised for so long loses its leases. A shorter one
  // means less delay when a worker dies, more heartbeats and less tolerance of a bad network.
  Duration lease_duration = std::chrono::seconds(10);
  // A worker that has not synchronised for so long is forgotten.
  Duration forget_after = std::chrono::seconds(100);
  SizingOptions sizing;
  // The share of ranges that a second worker renders again, and the secret that makes the choice
  // unpredictable.
  double audit_share = 0;
  std::uint64_t audit_secret = 0;
  // A job that lacks nothing but audits by lot, and has no worker that could do them, is done after this
  // time.
  Duration audit_patience = std::chrono::seconds(60);
  WorkPerEvent per_event{};
  // Signs leases. Results and reported leases count only with the token that this returns. By default all
  // tokens are empty.
  SignLease sign = [](LeaseId, const WorkerId&, const JobId&) { return LeaseToken{}; };
};

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

class Scheduler {
 public:
  explicit Scheduler(const Options& options);

  // Advances the time to `now`, which ends the leases of lost workers, then handles the event. A time before
  // that of an earlier call counts as the earlier time.
  Actions handle(const Event& event, Time now);

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

 private:
  // Each handles one event. Events of a worker that awaits a reply, or would take one, return the worker.
  Worker* on(const Synchronize& event, Actions& actions);
  Worker* on(const TopUp& event, Actions& actions);
  Worker* on(const Dismiss& event, Actions& actions);
  Worker* on(const Drain& event, Actions& actions);
  Worker* on(const Distrust& event, Actions& actions);
  Worker* on(const Trust& event, Actions& actions);
  Worker* on(const SubmitResult& event, Actions& actions);
  Worker* on(const DeferResult& event, Actions& actions);
  Worker* on(const SubmitJob& event, Actions& actions);
  Worker* on(const RestoreJob& event, Actions& actions);
  Worker* on(const ReopenJob& event, Actions& actions);
  Worker* on(const PauseJob& event, Actions& actions);
  Worker* on(const ResumeJob& event, Actions& actions);
  Worker* on(const CancelJob& event, Actions& actions);
  Worker* on(const DeleteJob& event, Actions& actions);
  Worker* on(const ReleaseJob& event, Actions& actions);
  void remove(Job& job, Actions& actions);
  Worker* on(const ExtendJob& event, Actions& actions);
  Worker* on(const UpdateJob& event, Actions& actions);
  Worker* on(const FailJob& event, Actions& actions);
  Worker* on(const DropTile& event, Actions& actions);
  Worker* on(const Tick& event, Actions& actions);

  // ---- Time and answers (scheduler.cpp) ----
  void begin_event();
  void count_verdicts(const std::vector<Verdict>& verdicts);
  void report_progress(Actions& actions);
  void expire_workers(Actions& actions);
  void expire(Worker& worker, Actions& actions);
  // Does for the sender of an event what others may leave for later.
  void settle_sender(const Event& event, Actions& actions);
  void wake_waiting(Actions& actions);
  Reply reply_to(Worker& worker);
  Reply reply_with_answer(Worker& worker, const SubmitResult& result);
  void tell_to_stop(Worker& worker, Reply& reply);
  // Leaves the worker's Synchronize unanswered.
  void let_wait(Worker& worker);
  void stop_waiting(Worker& worker);

  // ---- Leases (leasing.cpp, granting.cpp, stalls.cpp) ----
  void settle_reported(Worker& worker);
  // Ends a worker's leases of each job to which it has contributed nothing for too long.
  void end_stalled_leases(Worker& worker, Actions& actions);
  std::set<JobId> stalled_jobs(const Worker& worker) const;
  void stall(Worker& worker, const JobId& job, Actions& actions);
  // Returns its length; none for a worker that fetches the job's files.
  Duration begin_cooldown(Worker& worker, Job& job, Duration without_progress);
  // The samples in which the worker is stuck, if that is why its leases of these jobs stalled.
  std::optional<Stuck> what_keeps(const Worker& worker, const std::set<JobId>& stalled) const;
  // A stuck worker has synchronised: it goes on, or it was stuck long enough to count against its samples.
  void look_after_stuck(Worker& worker, Actions& actions);
  void strike_stuck_ranges(Worker& worker, Actions& actions);
  void give_up_if_nobody_gets_on(Job& job, Actions& actions);
  // The expected time for all samples that it holds.
  double expected_seconds(const Worker& worker) const;
  // Whether its samples can count for the job.
  static bool can_render(const Worker& worker, const Job& job);
  // Whether the worker may be given leases of the job, whatever work there is.
  bool may_take(const Worker& worker, const Job& job) const;
  // The worker is given none since they stalled and it fetches the files.
  static bool awaits_files(const Worker& worker, const Job& job);
  void adopt(Worker& worker, const LeaseDescription& reported);
  void top_up(Worker& worker);
  // The number of workers that share the job's work.
  int sharers(const Job& job) const;
  // The job of which the worker is given its next lease. `also_refused`: include jobs that it has refused
  // lately.
  Job* choose(const Worker& worker, bool also_refused);
  std::optional<JobNumber> chosen(const Worker& worker, bool also_refused) const;
  bool can_be_given(const Worker& worker, const Job& job, bool also_refused) const;
  bool grant_free(Worker& worker, bool also_refused);
  bool grant_copy(Worker& worker);
  void grant(Worker& worker, Job& job, Portion portion);
  void charge(Job& job, const Portion& portion);
  void enter_lease(Worker& worker, Job& job, Lease lease);
  std::vector<JobSnapshot> snapshots(const std::vector<JobNumber>& jobs) const;
  // The worker has reported within lease_duration that it cannot build the scene.
  bool has_refused_lately(const Worker& worker, const Job& job) const;
  Lease end_lease(Job& job, LeaseId id, LeaseState to);
  // Its leases go to others, and it is given nothing until it asks again.
  void end_all_leases(Worker& worker);
  // Ends a lease whose holder is presumed dead, and counts that against its samples.
  void lose_lease(const Worker& worker, const HeldLease& held, Actions& actions);
  // The worker is alive: withdraws the strikes if it was presumed dead.
  void withdraw_strikes_if_lost(const WorkerId& worker);
  // Removes an ended lease from its holder's entry.
  void forget_lease(const Job& job, const Lease& lease);
  void forget_held(Worker& holder, LeaseId lease);
  void count_ended(LeaseState state);
  // The same for leases that ended because nothing of them is missing.
  void forget_emptied(const Job& job, const std::vector<Lease>& leases);

  // ---- Jobs (jobs.cpp, ended_runs.cpp) ----
  // The job may change: it is entered in the indexes again before these are next used.
  Job* find(const JobId& id);
  Job& at(JobNumber number);
  const Job* find(const JobId& id) const;
  Job* find_or_refuse(const JobId& id, Actions& actions);
  core::Status may_add(const JobId& id, const JobShape& shape) const;
  Job& add(const JobId& id, const JobShape& shape, const SchedulingPolicy& policy, JobState state,
           const std::vector<IntervalSet>& done, Actions& actions);
  // The only function that changes a job's state, with all consequences. Refuses invalid transitions.
  void become(Job& job, JobState to, Actions& actions);
  // The job must be running or paused.
  void fail(Job& job, const Failure& failure, Actions& actions);
  // Complete, with nothing left to verify, and searched for samples of distrusted workers.
  bool settled(const Job& job) const { return job.settled() && !reviews_.contains(job.number()); }
  void refresh_indexes();
  // Ends a run of the job: revokes its leases, and makes all notes of it stale.
  void end_run(Job& job, Actions& actions);
  void clear_ended_runs(Actions& actions);
  bool clear_one_of(EndedRun& run);
  void revoke(EndedRun& run, LeaseId lease);
  void revoke_ended(Worker& worker);
  void forget_refusal(const WorkerId& worker, RunNumber run);
  JobNotes& notes(Worker& worker, const Job& job);
  Effort& effort(Worker& worker, const Job& job);

  // ---- Results (results.cpp, declines.cpp) ----
  core::Status validate(const Job& job, const SubmitResult& event) const;
  core::Status validate_lease(const Job& job, const SubmitResult& event) const;
  // Whether an earlier run may have extended the job by the item's samples, and lost that in a crash.
  bool was_extended_before(const Job& job, LeaseId lease, const WorkItem& item) const;
  // Whether the worker can be given leases with the answer to its result.
  bool takes_with_answer(const Worker& worker, const SubmitResult& event) const;
  // Whether the worker must be told of lost leases.
  static bool has_lost(const Worker& worker, const SubmitResult& event);
  void measure(Job& job, const SubmitResult& event);
  void note_counted(Job& job, const SubmitResult& event, std::uint64_t accepted, std::uint64_t audited,
                    Actions& actions);
  void note_refusal(Job& job, const SubmitResult& event, Actions& actions);
  // Look at the workers that could render the job and would report it if they cannot.
  AreAll are_all_names(const Job& job) const;
  AreAll are_all_principals(const Job& job) const;
  // The stalled workers among those that could otherwise be counted, by a part of their description.
  std::map<std::string, int> stalled_by(const Job& job, std::string WorkerInfo::*part) const;
  void note_producer(Job& job, const WorkItem& item, const Producer& producer,
                     const Fingerprint& fingerprint);
  // Wakes the other holders of the item's samples, so that they hear at once that these are done.
  void spare_others(const Job& job, const WorkItem& item, const WorkerId& deliverer);

  // ---- Audits (auditing.cpp, reviews.cpp, waits.cpp) ----
  bool can_audit(const Job& job, const Worker& worker) const;
  // An audit that another worker has in progress; empty if this worker may not do it.
  Portion audit_copy(const Job& job, const Worker& worker) const;
  std::optional<Ruling> take_audit(Job& job, const SubmitResult& event, std::size_t i);
  void follow(Job& job, const Ruling& ruling, Actions& actions);
  void disprove(const Job& job, const Ruling& ruling, ProducerNumber producer, Actions& actions);
  void drop_tile(Job& job, int tile, Actions& actions);
  void distrust(const Producer& producer, Actions& actions);
  // Wakes workers whose leases have shrunk.
  void tell_of_less(const std::vector<WorkerId>& workers);
  void restore_producers(Job& job, const std::vector<ProducedItem>& provenance);
  Producer producer_of(const WorkerId& worker) const;
  void review_jobs(Actions& actions);
  bool review(Job& job, ReviewQueue::Position& position, Actions& actions);
  void finish_review(Job& job, bool reopened, Actions& actions);
  void end_hopeless_waits(Actions& actions);
  void look_for_auditor(JobNumber number);
  void give_up_audits(Job& job, Actions& actions);
  static bool lacks_only_lots(const Job& job);
  std::optional<WorkerId> find_auditor(const Job& job) const;
  std::optional<WorkerId> find_auditor_at_work(const Job& job) const;
  std::optional<WorkerId> find_auditor_among(const Job& job, const std::set<WorkerId>& workers) const;
  bool would_audit(const Job& job, const WorkerId& worker) const;
  static bool is_no_help(const Job& job, const Worker& worker);
  std::uint64_t workers_version() const { return 1 + registry_.times_changed() + producers_.times_changed(); }

  // ---- Views and invariants (views.cpp, check.cpp) ----
  JobView job_view(const Job& job, Time now) const;
  Waiting waiting_of(const Job& job) const;
  WorkerView worker_view(const Worker& worker, Time now) const;
  std::vector<CooldownView> cooldowns_of(const Worker& worker, Time now) const;
  std::optional<std::string> check_next(CheckCursor& cursor, std::size_t& left) const;
  std::optional<std::string> check_leases(const Job& job, CheckCursor& cursor, std::size_t& left) const;
  std::optional<std::string> check_workers(CheckCursor& cursor, std::size_t& left) const;
  std::optional<std::string> check_job(const Job& job) const;
  std::optional<std::string> check_lease(const Job& job, const Lease& lease) const;
  std::optional<std::string> check_worker(const Worker& worker) const;
  std::optional<std::string> check_held(const Worker& worker, const HeldLease& held) const;
  std::optional<std::string> check_idle(const Worker& worker) const;
  std::optional<std::string> check_sums() const;
  std::optional<std::string> check_every_job(const Worker& worker) const;
  std::optional<std::string> check_choice(const Worker& worker) const;
  std::optional<JobNumber> chosen_of_all(const Worker& worker, bool also_refused) const;

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

  // During one event: whether there may be new work to lease, whose leases have ended or shrunk, and what it
  // may still do.
  bool work_appeared_ = false;
  std::set<WorkerId> lost_leases_;
  WorkPerEvent left_;
  // Those that may have to be named in Actions::progressed_jobs and progressed_workers.
  std::set<JobNumber> progressed_jobs_;
  std::set<WorkerId> progressed_workers_;
};

}  // namespace tessera::scheduler
