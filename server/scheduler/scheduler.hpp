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

#include <optional>
#include <set>
#include <vector>

#include "server/scheduler/events.hpp"
#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/options.hpp"

namespace tessera::scheduler {

class Scheduler : public FarmState {
 public:
  explicit Scheduler(const Options& options) : FarmState(options) {}

  // Advances the time to `now`, which ends the leases of lost workers, then handles the event. A time before
  // that of an earlier call counts as the earlier time.
  Actions handle(const Event& event, Time now);

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
  void adopt(Worker& worker, const LeaseDescription& reported);
  void top_up(Worker& worker);
  // The job of which the worker is given its next lease. `also_refused`: include jobs that it has refused
  // lately.
  Job* choose(const Worker& worker, bool also_refused);
  bool grant_free(Worker& worker, bool also_refused);
  bool grant_copy(Worker& worker);
  void grant(Worker& worker, Job& job, Portion portion);
  void charge(Job& job, const Portion& portion);
  void enter_lease(Worker& worker, Job& job, Lease lease);
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
  using FarmState::find;
  // The job may change: it is entered in the indexes again before these are next used.
  Job* find(const JobId& id);
  Job& at(JobNumber number);
  Job* find_or_refuse(const JobId& id, Actions& actions);
  core::Status may_add(const JobId& id, const JobShape& shape) const;
  Job& add(const JobId& id, const JobShape& shape, const SchedulingPolicy& policy, JobState state,
           const std::vector<IntervalSet>& done, Actions& actions);
  // The only function that changes a job's state, with all consequences. Refuses invalid transitions.
  void become(Job& job, JobState to, Actions& actions);
  void remove(Job& job, Actions& actions);
  // The job must be running or paused.
  void fail(Job& job, const Failure& failure, Actions& actions);
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

  // ---- Results (results.cpp) ----
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
  void note_producer(Job& job, const WorkItem& item, const Producer& producer,
                     const Fingerprint& fingerprint);
  // Wakes the other holders of the item's samples, so that they hear at once that these are done.
  void spare_others(const Job& job, const WorkItem& item, const WorkerId& deliverer);

  // ---- Audits (auditing.cpp, reviews.cpp, waits.cpp) ----
  std::optional<Ruling> take_audit(Job& job, const SubmitResult& event, std::size_t i);
  void follow(Job& job, const Ruling& ruling, Actions& actions);
  void disprove(const Job& job, const Ruling& ruling, ProducerNumber producer, Actions& actions);
  void drop_tile(Job& job, int tile, Actions& actions);
  void distrust(const Producer& producer, Actions& actions);
  // Wakes workers whose leases have shrunk.
  void tell_of_less(const std::vector<WorkerId>& workers);
  void restore_producers(Job& job, const std::vector<ProducedItem>& provenance);
  Producer producer_of(const SubmitResult& result) const;
  void review_jobs(Actions& actions);
  bool review(Job& job, ReviewQueue::Position& position, Actions& actions);
  void finish_review(Job& job, bool reopened, Actions& actions);
  void end_hopeless_waits(Actions& actions);
  void look_for_auditor(JobNumber number);
  void give_up_audits(Job& job, Actions& actions);

  // During one event: whether there may be new work to lease, and whose leases have ended or shrunk.
  bool work_appeared_ = false;
  std::set<WorkerId> lost_leases_;
  // Those that may have to be named in Actions::progressed_jobs and progressed_workers.
  std::set<JobNumber> progressed_jobs_;
  std::set<WorkerId> progressed_workers_;
};

}  // namespace tessera::scheduler
