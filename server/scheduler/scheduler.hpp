// SPDX-License-Identifier: Apache-2.0
// The farm's scheduler: which worker renders which samples of which job.
//
// A deterministic state machine. handle() takes what happened and when, and answers what is to be done;
// nothing else changes it. It has no threads, no I/O, no clock and no randomness, and knows nothing of RPC,
// storage or pixels: whoever runs it serialises the calls, adds accepted results to the film, stores what
// must survive, and calls handle(Tick) at next_deadline(). Not thread-safe; the calls are short.
//
// What it sees to, at every moment (check_invariants):
//   - a sample of a running or paused job is done, or leased to at most two workers, or free to be leased;
//   - a range is accepted only if all of its samples are missing, so none is counted twice;
//   - a done job lacks nothing;
//   - no more workers hold leases of a job than it allows, or than did when it was last allowed fewer;
//   - leases are held by known workers that were heard of within lease_duration, and of whose deliveries for
//     the job something has counted within patience() (policy.hpp);
//   - a worker that waits, holds nothing and would take a lease waits because there is none to give;
//   - samples that are due for an audit are rendered again by a worker of another name, and their job is not
//     done before;
//   - samples that a worker may have died of, or is stuck in, are leased to workers that hold nothing else,
//     and when they have cost three workers of different names in a row their job fails, so that they do not
//     take down the farm;
//   - a worker that is stuck holds nothing.
//
// After a restart, hand in RestoreJob for each stored job, in the order of their submission, with a higher
// epoch. Workers then report leases that this scheduler has not given; it takes them over where their samples
// are still missing. Samples that were accepted after the last checkpoint are missing again, and are rendered
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
  // Distinguishes this run of the coordinator from all earlier ones; must be higher than theirs. 24 bits.
  std::uint32_t epoch = 1;
  // A worker that has not synchronised for so long loses its leases. Shorter: less delay when a worker dies;
  // more heartbeats, and less patience with a bad network.
  Duration lease_duration = std::chrono::seconds(10);
  // A worker that has not synchronised for so long is forgotten altogether.
  Duration forget_after = std::chrono::seconds(100);
  SizingOptions sizing;
  // Which share of ranges is rendered again by another worker, and what makes it unpredictable which.
  double audit_share = 0;
  std::uint64_t audit_secret = 0;
  // A job that lacks nothing but audits by lot, for which no worker of another name is there, is done after
  // so long.
  Duration audit_patience = std::chrono::seconds(60);
  // Signs leases. Results and reported leases count only with the token that this makes; by default all
  // tokens are empty.
  SignLease sign = [](LeaseId, const WorkerId&, const JobId&) { return LeaseToken{}; };
};

// A job as its users see it. Samples are pixel samples.
struct JobView {
  JobId id;
  JobShape shape;
  int priority = 0;
  JobState state = JobState::kRunning;
  std::string failure;
  std::uint64_t samples_done = 0;
  std::uint64_t samples_total = 0;
  // Over the last seconds and all workers; 0 while unknown.
  double samples_per_second = 0;
  // Workers that hold a lease on it.
  int active_workers = 0;
  // Most that may; 0 for as many as there are.
  std::uint32_t max_workers = 0;
  // Of samples_done, those that another worker is to render again.
  std::uint64_t samples_to_verify = 0;
};

// A job of which a worker is given nothing for a while, since its leases of it have stalled.
struct CooldownView {
  JobId job;
  Duration remaining{};
  // For as long as it says that it is fetching the job's files.
  bool fetching = false;
};

struct WorkerView {
  WorkerInfo info;
  int held_leases = 0;
  // Over the last seconds; 0 while unknown.
  double samples_per_second = 0;
  // Pixel samples of it that were counted.
  std::uint64_t samples_accepted = 0;
  // Its last Synchronize or SubmitResult.
  Time last_seen{};
  bool draining = false;
  // Not heard of for lease_duration: it holds nothing, and is shown until forget_after.
  bool silent = false;
  // Of Worker.
  std::uint64_t audited_ranges = 0, disproved_ranges = 0;
  // It is given nothing, since it says that it is still rendering what went to others.
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

  // Lets time advance to `now`, which takes leases from workers that are lost, then takes the
  // event. A time before that of an earlier call is taken for that one.
  Actions handle(const Event& event, Time now);

  // When the next lease runs out, worker is forgotten or wait for an auditor ends: handle(Tick{}, …) is due
  // then. Absent: never.
  std::optional<Time> next_deadline() const;

  // Speeds are those at `now`.
  std::optional<JobView> job(const JobId& id, Time now) const;
  // In the order of submission.
  std::vector<JobView> jobs(Time now) const;
  // Those whose ids begin so; of more than `most` the latest. Takes time for these alone.
  std::vector<JobView> jobs(Time now, std::string_view id_prefix, std::size_t most) const;
  // In the order of their ids.
  std::vector<WorkerView> workers(Time now) const;

  // The samples of one tile that are done, for checkpoints. The job must exist and have the tile. Valid until
  // the next handle().
  const IntervalSet& done(const JobId& id, int tile) const;

  // Who rendered the samples of one tile, as far as nobody has confirmed them; for checkpoints, with done().
  std::vector<ProducedItem> provenance(const JobId& id, int tile) const;

  // What is wrong, as a sentence; absent if nothing is. Anything else is a defect of the scheduler.
  std::optional<std::string> check_invariants(CheckDepth depth) const;

 private:
  // Jobs in the order of submission.
  using JobNumber = std::uint64_t;

  // Each takes one event. Those of a worker that awaits a reply, or would take one, return it.
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
  Worker* on(const Tick& event, Actions& actions);

  // ---- Time and answers (scheduler.cpp) ----
  void take_leases_of_silent_workers(Actions& actions);
  void wake_waiting(Actions& actions);
  // Who of those that wait is asked first whether it can be given something.
  static bool comes_before(const Worker* a, const Worker* b);
  Reply reply_to(Worker& worker);
  Reply reply_with_answer(Worker& worker, const SubmitResult& result);
  // The worker's Synchronize goes unanswered.
  void let_wait(Worker& worker);

  // ---- Leases (leasing.cpp, stalls.cpp) ----
  void settle_reported(Worker& worker);
  // Takes from a worker the leases of each job to which it has contributed nothing for too long.
  void end_stalled_leases(Worker& worker, Actions& actions);
  std::set<JobId> stalled_jobs(const Worker& worker) const;
  void stall(Worker& worker, const JobId& job, Actions& actions);
  Duration bar(Worker& worker, const JobId& job, Duration without_progress);
  // What it is stuck in, if it has leases of these jobs without progress for that reason.
  std::optional<Stuck> what_keeps(const Worker& worker, const std::set<JobId>& stalled) const;
  // A worker that was stuck has called: it is not any more, or for so long that its samples are to blame.
  void look_after_stuck(Worker& worker, Actions& actions);
  void strike_stuck_ranges(Worker& worker, Actions& actions);
  void give_up_if_nobody_gets_on(Job& job, Actions& actions);
  // How long all that it holds should take it.
  double expected_seconds(const Worker& worker) const;
  // Whether it can be given leases of the job, whatever there is to do of it.
  bool may_take(const Worker& worker, const Job& job) const;
  void adopt(Worker& worker, const LeaseDescription& reported);
  void top_up(Worker& worker);
  // How many workers share the job's work.
  int sharers(const Job& job) const;
  // `also_refused`: of jobs that it has refused lately as well.
  bool grant_free(Worker& worker, bool also_refused);
  bool grant_copy(Worker& worker);
  void grant(Worker& worker, Job& job, Portion portion);
  void charge(Job& job, const Portion& portion);
  void enter_lease(Worker& worker, Job& job, Lease lease);
  std::vector<JobSnapshot> snapshots(const std::vector<Job*>& jobs) const;
  // The worker has said within lease_duration that it cannot build the scene.
  bool has_refused_lately(const Worker& worker, const Job& job) const;
  Lease end_lease(Job& job, LeaseId id, LeaseState to);
  // Whatever it holds goes to others, and it is given nothing until it asks again.
  void end_all_leases(Worker& worker);
  // Ends a lease whose holder is taken for dead, and what that makes of the job.
  void lose_lease(const Worker& worker, const HeldLease& held, Actions& actions);
  // The worker gives a sign of life. One that was taken for dead was not.
  void withdraw_strikes_if_lost(const WorkerId& worker);
  // Strikes an ended lease from its holder's entry.
  void forget_lease(const Job& job, const Lease& lease);
  // The same with leases of which all is delivered.
  void forget_emptied(const Job& job, const std::vector<Lease>& leases);

  // ---- Jobs (jobs.cpp) ----
  Job* find(const JobId& id);
  const Job* find(const JobId& id) const;
  Job* find_or_refuse(const JobId& id, Actions& actions);
  core::Status may_add(const JobId& id, const JobShape& shape) const;
  Job& add(const JobId& id, const JobShape& shape, const SchedulingPolicy& policy, JobState state,
           std::vector<IntervalSet> done);
  // The one way in which a job's state changes, with everything that follows from it. Refuses what is not
  // legal.
  void become(Job& job, JobState to, Actions& actions);
  // It must be running or paused.
  void fail(Job& job, const std::string& failure, Actions& actions);
  void end_all_leases(Job& job);
  // Strikes what workers are known for on a job that needs none any more.
  void forget_worker_notes(const JobId& job);

  // ---- Results (results.cpp) ----
  core::Status validate(const Job& job, const SubmitResult& event) const;
  core::Status validate_lease(const Job& job, const SubmitResult& event) const;
  // Whether the item may be of samples that an earlier run had extended the job by, and forgot in a crash.
  bool was_extended_before(const Job& job, LeaseId lease, const WorkItem& item) const;
  // Whether its worker can be given leases with the answer.
  bool takes_with_answer(const Worker& worker, const SubmitResult& event) const;
  // Whether it must be told of anything but new leases.
  static bool has_lost(const Worker& worker, const SubmitResult& event);
  // Whether a worker waits that has nothing to do.
  bool any_idle() const;
  void measure(Job& job, const SubmitResult& event);
  void note_refusal(Job& job, const SubmitResult& event, Actions& actions);
  // Of the workers that could render the job, and say so if they cannot.
  FindPrincipals find_principals(const Job& job) const;
  void note_producer(Job& job, const WorkItem& item, const Producer& producer,
                     const Fingerprint& fingerprint);
  // Sees to it that whoever else holds samples of an item hears at once that they are done.
  void spare_others(const Job& job, const WorkItem& item, const WorkerId& deliverer);

  // ---- Audits (auditing.cpp) ----
  bool can_audit(const Job& job, const Worker& worker) const;
  // What another audits, for a second time; nothing if the worker may not.
  Portion audit_copy(const Job& job, const Worker& worker) const;
  std::optional<Ruling> take_audit(Job& job, const SubmitResult& event, std::size_t i);
  void follow(Job& job, const Ruling& ruling, Actions& actions);
  void disprove(const Job& job, const Ruling& ruling, ProducerNumber producer, Actions& actions);
  void drop_tile(Job& job, int tile, Actions& actions);
  void distrust(const Producer& producer, Actions& actions);
  // They have less to do.
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
  // Of all jobs: an id that is in use cannot be taken over a second time.
  std::set<LeaseId> live_leases_;
  std::uint64_t servings_ = 0;
  // Of JobSnapshot: where the latest lease began. Never goes back.
  double virtual_time_ = 0;

  std::map<JobNumber, Job> jobs_;
  std::map<JobId, JobNumber> job_numbers_;
  JobNumber last_job_number_ = 0;
  std::set<JobNumber> running_;
  WorkerRegistry registry_;
  Producers producers_;
  // Every worker that waits and could be given more, by arrival; may also have others. So that an event does
  // not cost more the more workers there are.
  std::map<std::uint64_t, WorkerId> idle_waiters_;

  // Of the event at hand: whether there may be something to lease that was not there before, and whose leases
  // have ended or shrunk.
  bool work_appeared_ = false;
  std::set<WorkerId> lost_leases_;
};

}  // namespace tessera::scheduler
