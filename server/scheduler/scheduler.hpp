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
//   the job within patience() (policy.hpp).
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
#include <vector>

#include "server/scheduler/events.hpp"
#include "server/scheduler/job.hpp"
#include "server/scheduler/policy.hpp"
#include "server/scheduler/types.hpp"
#include "server/scheduler/worker_registry.hpp"

namespace tessera::scheduler {

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
  // Signs leases. Results and reported leases count only with the token that this returns. By default all
  // tokens are empty.
  SignLease sign = [](LeaseId, const WorkerId&, const JobId&) { return LeaseToken{}; };
};

// A job as its users see it. All counts are in pixel samples.
struct JobView {
  JobId id;
  JobShape shape;
  int priority = 0;
  JobState state = JobState::kRunning;
  std::string failure;
  std::uint64_t samples_done = 0;
  std::uint64_t samples_total = 0;
  // Over the last seconds and all workers; 0 if unknown.
  double samples_per_second = 0;
  // The workers that hold a lease of it.
  int active_workers = 0;
  // The limit on active_workers; 0 for none.
  std::uint32_t max_workers = 0;
  // The part of samples_done that another worker must render again.
  std::uint64_t samples_to_verify = 0;
};

// A job of which a worker is given no leases for a while, since its leases of it have stalled.
struct CooldownView {
  JobId job;
  Duration remaining{};
  // The cooldown lasts while the worker reports that it fetches the job's files.
  bool fetching = false;
};

struct WorkerView {
  WorkerInfo info;
  int held_leases = 0;
  // Over the last seconds; 0 if unknown.
  double samples_per_second = 0;
  // The pixel samples that were accepted from it.
  std::uint64_t samples_accepted = 0;
  // The time of its last Synchronize or SubmitResult.
  Time last_seen{};
  bool draining = false;
  // It has not synchronised for lease_duration: it holds nothing, and is listed until forget_after.
  bool silent = false;
  // See Worker.
  std::uint64_t audited_ranges = 0, disproved_ranges = 0;
  // It is given nothing, since it reports that it still renders samples that went to others.
  bool stuck = false;
  std::vector<CooldownView> cooldowns{};
};

enum class CheckDepth {
  kCounters,    // linear in jobs, workers and leases: for production
  kEverySample  // linear in tiles as well: for tests
};

class Scheduler {
 public:
  explicit Scheduler(const Options& options);

  // Advances the time to `now`, which ends the leases of lost workers, then handles the event. A time before
  // that of an earlier call counts as the earlier time.
  Actions handle(const Event& event, Time now);

  // When the next lease expires, worker is forgotten or wait for an auditor ends: handle(Tick{}, …) is due
  // then. Absent: never.
  std::optional<Time> next_deadline() const;

  // Speeds are those at `now`.
  std::optional<JobView> job(const JobId& id, Time now) const;
  // In the order of submission.
  std::vector<JobView> jobs(Time now) const;
  // Jobs whose ids begin with the prefix; at most the latest `most`. The time is proportional to these alone.
  std::vector<JobView> jobs(Time now, std::string_view id_prefix, std::size_t most) const;
  // In the order of ids.
  std::vector<WorkerView> workers(Time now) const;
  // Empty if it is unknown or forgotten.
  std::optional<WorkerView> worker(const WorkerId& id, Time now) const;

  // The samples of one tile that are done, for checkpoints. The job must exist and have the tile. Valid until
  // the next handle().
  const IntervalSet& done(const JobId& id, int tile) const;

  // The producers of one tile's samples that nobody has confirmed; for checkpoints, with done().
  std::vector<ProducedItem> provenance(const JobId& id, int tile) const;

  // The first violated invariant as a sentence; empty if there is none. A violation is a defect of the
  // scheduler.
  std::optional<std::string> check_invariants(CheckDepth depth) const;

 private:
  // Numbers jobs in the order of submission.
  using JobNumber = std::uint64_t;

  // Each handles one event. Events of a worker that awaits a reply, or would take one, return the worker.
  Worker* on(const Synchronize& event, Actions& actions);
  Worker* on(const TopUp& event, Actions& actions);
  Worker* on(const Dismiss& event, Actions& actions);
  Worker* on(const SubmitResult& event, Actions& actions);
  Worker* on(const SubmitJob& event, Actions& actions);
  Worker* on(const RestoreJob& event, Actions& actions);
  Worker* on(const ReopenJob& event, Actions& actions);
  Worker* on(const PauseJob& event, Actions& actions);
  Worker* on(const ResumeJob& event, Actions& actions);
  Worker* on(const CancelJob& event, Actions& actions);
  Worker* on(const DeleteJob& event, Actions& actions);
  Worker* on(const ExtendJob& event, Actions& actions);
  Worker* on(const UpdateJob& event, Actions& actions);
  Worker* on(const FailJob& event, Actions& actions);
  Worker* on(const DropTile& event, Actions& actions);
  Worker* on(const Tick& event, Actions& actions);

  // ---- Time and answers (scheduler.cpp) ----
  void take_leases_of_silent_workers(Actions& actions);
  void wake_waiting(Actions& actions);
  // The order in which waiting workers are offered new work.
  static bool comes_before(const Worker* a, const Worker* b);
  Reply reply_to(Worker& worker);
  Reply reply_with_answer(Worker& worker, const SubmitResult& result);
  // Leaves the worker's Synchronize unanswered.
  void let_wait(Worker& worker);

  // ---- Leases (leasing.cpp, stalls.cpp) ----
  void settle_reported(Worker& worker);
  // Ends a worker's leases of each job to which it has contributed nothing for too long.
  void end_stalled_leases(Worker& worker, Actions& actions);
  std::set<JobId> stalled_jobs(const Worker& worker) const;
  void stall(Worker& worker, const JobId& job, Actions& actions);
  Duration bar(Worker& worker, const JobId& job, Duration without_progress);
  // The samples in which the worker is stuck, if that is why its leases of these jobs stalled.
  std::optional<Stuck> what_keeps(const Worker& worker, const std::set<JobId>& stalled) const;
  // A stuck worker has synchronised: it goes on, or it was stuck long enough to count against its samples.
  void look_after_stuck(Worker& worker, Actions& actions);
  void strike_stuck_ranges(Worker& worker, Actions& actions);
  void give_up_if_nobody_gets_on(Job& job, Actions& actions);
  // The expected time for all samples that it holds.
  double expected_seconds(const Worker& worker) const;
  // Whether the worker may be given leases of the job, whatever work there is.
  bool may_take(const Worker& worker, const Job& job) const;
  void adopt(Worker& worker, const LeaseDescription& reported);
  void top_up(Worker& worker);
  // The number of workers that share the job's work.
  int sharers(const Job& job) const;
  // `also_refused`: include jobs that it has refused lately.
  bool grant_free(Worker& worker, bool also_refused);
  bool grant_copy(Worker& worker);
  void grant(Worker& worker, Job& job, Portion portion);
  void charge(Job& job, const Portion& portion);
  void enter_lease(Worker& worker, Job& job, Lease lease);
  std::vector<JobSnapshot> snapshots(const std::vector<Job*>& jobs) const;
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
  // The same for leases that ended because nothing of them is missing.
  void forget_emptied(const Job& job, const std::vector<Lease>& leases);

  // ---- Jobs (jobs.cpp) ----
  Job* find(const JobId& id);
  const Job* find(const JobId& id) const;
  Job* find_or_refuse(const JobId& id, Actions& actions);
  core::Status may_add(const JobId& id, const JobShape& shape) const;
  Job& add(const JobId& id, const JobShape& shape, const SchedulingPolicy& policy, JobState state,
           std::vector<IntervalSet> done);
  // The only function that changes a job's state, with all consequences. Refuses invalid transitions.
  void become(Job& job, JobState to, Actions& actions);
  // The job must be running or paused.
  void fail(Job& job, const std::string& failure, Actions& actions);
  void end_all_leases(Job& job);
  // Removes the workers' speeds, refusals and efforts of a job that takes no more leases.
  void forget_worker_notes(const JobId& job);

  // ---- Results (results.cpp) ----
  core::Status validate(const Job& job, const SubmitResult& event) const;
  core::Status validate_lease(const Job& job, const SubmitResult& event) const;
  // Whether an earlier run may have extended the job by the item's samples, and lost that in a crash.
  bool was_extended_before(const Job& job, LeaseId lease, const WorkItem& item) const;
  // Whether the worker can be given leases with the answer to its result.
  bool takes_with_answer(const Worker& worker, const SubmitResult& event) const;
  // Whether the worker must be told of lost leases.
  static bool has_lost(const Worker& worker, const SubmitResult& event);
  // Whether an idle worker waits.
  bool any_idle() const;
  void measure(Job& job, const SubmitResult& event);
  void note_refusal(Job& job, const SubmitResult& event, Actions& actions);
  // Finds the principals of workers that could render the job and would report it if they cannot.
  FindPrincipals find_principals(const Job& job) const;
  void note_producer(Job& job, const WorkItem& item, const Producer& producer,
                     const Fingerprint& fingerprint);
  // Wakes the other holders of the item's samples, so that they hear at once that these are done.
  void spare_others(const Job& job, const WorkItem& item, const WorkerId& deliverer);

  // ---- Audits (auditing.cpp) ----
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
  void end_hopeless_waits(Actions& actions);
  bool cannot_progress(const Job& job) const;
  Producer producer_of(const WorkerId& worker) const;

  std::optional<std::string> check_workers() const;
  std::optional<std::string> check_idle(CheckDepth depth) const;

  const Options options_;
  Time now_{};
  LeaseId last_lease_id_;
  // The leases of all jobs: an id in use cannot be taken over a second time.
  std::set<LeaseId> live_leases_;
  std::uint64_t servings_ = 0;
  // See JobSnapshot: where the latest lease began. Never decreases.
  double virtual_time_ = 0;

  std::map<JobNumber, Job> jobs_;
  std::map<JobId, JobNumber> job_numbers_;
  JobNumber last_job_number_ = 0;
  std::set<JobNumber> running_;
  WorkerRegistry registry_;
  Producers producers_;
  // Contains every waiting worker that could be given more, in the order of registration; may contain others.
  // It makes the cost of an event independent of the number of workers.
  std::map<std::uint64_t, WorkerId> idle_waiters_;

  // During one event: whether there may be new work to lease, and whose leases have ended or shrunk.
  bool work_appeared_ = false;
  std::set<WorkerId> lost_leases_;
};

}  // namespace tessera::scheduler
