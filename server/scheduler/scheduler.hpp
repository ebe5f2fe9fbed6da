// SPDX-License-Identifier: Apache-2.0
// The farm's scheduler decides which worker renders which samples of which job.
//
// It is a deterministic state machine. handle() takes an event and its time, and returns the actions that
// follow; nothing else changes the state. It has no threads, no I/O, no clock and no randomness, and knows
// nothing of RPC, storage or pixels. Its caller serialises the calls, adds accepted results to the film,
// stores what must be durable, and calls handle(Tick) at next_deadline(). Not thread-safe; the calls are
// short.
//
// Its parts share a FarmState, and each is about one thing. Those that depend on others come after them:
//
//   Leases       leases begin and end                  Workers      they report, and fall silent
//   Jobs         the lifecycle of jobs                 Grants       who is given which work next
//   Reviews      samples of distrusted workers         Results      what is delivered is counted
//   Auditing     the outcomes of audits                JobCommands  what users ask of jobs
//   Losses       deaths of workers                     AuditWaivers audits for which there is nobody
//   Stalls       workers that deliver nothing          Replies      what workers are told
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

#include "server/scheduler/audit_waivers.hpp"
#include "server/scheduler/auditing.hpp"
#include "server/scheduler/events.hpp"
#include "server/scheduler/farm_view.hpp"
#include "server/scheduler/grants.hpp"
#include "server/scheduler/job_commands.hpp"
#include "server/scheduler/jobs.hpp"
#include "server/scheduler/leases.hpp"
#include "server/scheduler/losses.hpp"
#include "server/scheduler/options.hpp"
#include "server/scheduler/replies.hpp"
#include "server/scheduler/results.hpp"
#include "server/scheduler/reviews.hpp"
#include "server/scheduler/stalls.hpp"
#include "server/scheduler/workers.hpp"

namespace tessera::scheduler {

class Scheduler : public FarmView {
 public:
  explicit Scheduler(const Options& options) : FarmView(options) {}

  // Advances the time to `now`, which ends the leases of lost workers, then handles the event. A time before
  // that of an earlier call counts as the earlier time.
  Actions handle(const Event& event, Time now);

 private:
  // Hands the event to the part that handles it. Returns the worker that awaits a reply, or would take one.
  Worker* dispatch(const Event& event, Actions& actions);
  void count_verdicts(const std::vector<Verdict>& verdicts);
  void report_progress(Actions& actions);
  void report_unattended(Actions& actions);
  // Answers the sender of the event.
  void reply(Worker& worker, const SubmitResult* result, Actions& actions);

  Leases leases_{farm_};
  Jobs jobs_{farm_, leases_};
  Reviews reviews_{farm_, leases_, jobs_};
  Auditing auditing_{farm_, leases_, jobs_, reviews_};
  Losses losses_{farm_, leases_, jobs_};
  Stalls stalls_{farm_, leases_, jobs_};
  Workers workers_{farm_, leases_, losses_, stalls_, reviews_};
  Grants grants_{farm_, leases_, jobs_};
  Results results_{farm_, leases_, jobs_, losses_, auditing_};
  JobCommands commands_{farm_, jobs_, reviews_, auditing_};
  AuditWaivers waivers_{farm_, jobs_};
  Replies replies_{farm_, jobs_};
};

}  // namespace tessera::scheduler
