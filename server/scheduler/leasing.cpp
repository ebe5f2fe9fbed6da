// SPDX-License-Identifier: Apache-2.0
// Leases: renews, adopts, grants and ends them.
#include <algorithm>
#include <utility>

#include "server/scheduler/changes.hpp"
#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {
namespace {

// How late the scheduler may be called after a lease's expiry and still presume its holder dead.
constexpr Duration kPunctuality = std::chrono::seconds(1);

}  // namespace

Worker* Scheduler::on(const Synchronize& event, Actions& actions) {
  withdraw_strikes_if_lost(event.worker.id);
  const Worker* const known = registry_.find(event.worker.id);
  const bool drains = event.draining || (known != nullptr && known->drain_requested);
  const bool is_visible = known == nullptr || known->info != event.worker ||
                          known->state() != (drains ? WorkerState::kDraining : WorkerState::kPresent);
  if (is_visible) note_change(actions.changed_workers, event.worker.id);
  Worker& worker = registry_.heartbeat(event, now_);
  waiting_.leave(worker);
  producers_.introduce(worker.producer());
  settle_reported(worker);
  look_after_stuck(worker, actions);
  end_stalled_leases(worker, actions);
  for (const LeaseDescription& reported : event.held) adopt(worker, reported);
  return &worker;
}

Worker* Scheduler::on(const TopUp& event, Actions& actions) {
  Worker* const worker = registry_.find(event.worker);
  if (worker == nullptr || worker->state() == WorkerState::kSilent) {
    actions.status = core::fail(core::ErrorCode::kNotFound,
                                "worker " + event.worker.value + " has been silent for too long");
    return nullptr;
  }
  return worker;
}

Worker* Scheduler::on(const Dismiss& event, Actions& actions) {
  Worker* const worker = registry_.find(event.worker);
  if (worker == nullptr) {
    actions.status = core::fail(core::ErrorCode::kNotFound, "there is no worker " + event.worker.value);
    return nullptr;
  }
  end_all_leases(*worker);
  if (event.doubt) distrust(worker->producer(), actions);
  return nullptr;
}

Worker* Scheduler::on(const Drain& event, Actions& actions) {
  Worker* const worker = registry_.find(event.worker);
  if (worker == nullptr) {
    actions.status = core::fail(core::ErrorCode::kNotFound, "there is no worker " + event.worker.value);
    return nullptr;
  }
  registry_.request_drain(*worker, event.drain, event.stop);
  note_change(actions.changed_workers, event.worker);
  if (worker->waiting) let_wait(*worker);  // among those that can be given more, or no longer
  if (worker->stop_requested) lost_leases_.insert(event.worker);
  work_appeared_ = true;
  return nullptr;
}

Worker* Scheduler::on(const Distrust& event, Actions& actions) {
  distrust(event.producer, actions);
  return nullptr;
}

Worker* Scheduler::on(const Trust& event, Actions&) {
  producers_.trust(event.producer);
  work_appeared_ = true;
  return nullptr;
}

void Scheduler::settle_reported(Worker& worker) {
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases)) {
    // The worker has dropped leases that it reported before and does not report now. It may not have received
    // leases that it never reported.
    Job& job = at(held.number);
    if (worker.reported.contains(held.id)) {
      job.acknowledge(held.id);
    } else if (worker.state() == WorkerState::kDraining ||
               job.find_lease(held.id)->state == LeaseState::kHeld) {
      end_lease(job, held.id, LeaseState::kReturned);
    }
  }
}

// Adopts a lease that this scheduler does not know: one of an earlier run, or of a worker that was lost and
// returns before its samples went to others.
void Scheduler::adopt(Worker& worker, const LeaseDescription& reported) {
  Job* const job = find(reported.job);
  if (job == nullptr || !(job->state() == JobState::kRunning || job->state() == JobState::kPaused)) return;
  if (worker.holds_alone() || worker.stuck || !may_take(worker, *job)) return;
  const bool never_given = reported.id == LeaseId{} || reported.id > last_lease_id_;
  if (never_given || live_leases_.contains(reported.id)) return;
  if (static_cast<int>(worker.leases.size()) >= kMaxLeasesPerWorker) return;
  if (reported.token != options_.sign(reported.id, worker.info.id, reported.job)) return;
  std::vector<WorkItem> items = job->free_parts(reported.items);
  if (items.empty()) return;
  Lease lease{reported.id, worker.info.id, std::move(items)};
  lease.state = LeaseState::kHeld;
  enter_lease(worker, *job, std::move(lease));
  ++counts_.adopted_leases;
  work_appeared_ = true;
}

void Scheduler::enter_lease(Worker& worker, Job& job, Lease lease) {
  Effort& known = effort(worker, job);
  const bool resumes = known.gave_back && now_ - *known.gave_back < options_.lease_duration;
  if (!resumes && !worker.holds_any_of(job.number())) known.no_progress_since = now_;
  live_leases_.insert(lease.id);
  progressed_workers_.insert(worker.info.id);
  worker.leases.push_back({lease.id, job.id(), job.number(), job.run(), lease.alone});
  registry_.count_activity(worker);
  waiting_.update(worker);
  job.lease(std::move(lease));
  touched_.insert(job.number());
}

Lease Scheduler::end_lease(Job& job, LeaseId id, LeaseState to) {
  Lease lease = job.end_lease(id, to);
  forget_lease(job, lease);
  work_appeared_ = true;
  return lease;
}

void Scheduler::end_all_leases(Worker& worker) {
  worker.wanted_leases = 0;
  revoke_ended(worker);
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases))
    end_lease(at(held.number), held.id, LeaseState::kRevoked);
}

void Scheduler::lose_lease(const Worker& worker, const HeldLease& held, Actions& actions) {
  Job& job = at(held.number);
  const bool heard_of = worker.reported.contains(held.id);
  const Lease lease = end_lease(job, held.id, LeaseState::kExpired);
  // The death counts against the lease's samples only if the worker had the lease and the scheduler is on
  // time. A lease that it never reported may not have reached it. One that was told with the answer to a
  // result most likely has, and one death alone fails no job. A draining worker was told to stop. If the
  // deadline is long past, the coordinator itself was suspended.
  const bool draining = worker.state() == WorkerState::kDraining;
  if (!heard_of || draining || now_ > registry_.deadline(worker) + kPunctuality) return;
  const auto has_strikes = [this](const WorkerId& struck, const std::set<JobNumber>& jobs) {
    return std::any_of(jobs.begin(), jobs.end(), [&](JobNumber number) {
      const auto found = jobs_.find(number);
      return found != jobs_.end() && found->second.may_have_strikes_of(struck);
    });
  };
  struck_jobs_.at_or_insert(worker.info.id, has_strikes).insert(job.number());
  const auto failure = job.strike(lease, worker.loss(LossKind::kDied), are_all_principals(job));
  if (failure) fail(job, *failure, actions);
}

void Scheduler::withdraw_strikes_if_lost(const WorkerId& worker) {
  const Worker* const known = registry_.find(worker);
  if (known != nullptr && known->state() != WorkerState::kSilent) return;
  const std::set<JobNumber>* const struck = struck_jobs_.find(worker);
  if (struck == nullptr) return;
  for (const JobNumber number : *struck) {
    const auto job = jobs_.find(number);
    if (job != jobs_.end()) job->second.withdraw_strikes(worker, LossKind::kDied);
  }
  struck_jobs_.erase(worker);
}

void Scheduler::forget_lease(const Job& job, const Lease& lease) {
  Worker& holder = *registry_.find(lease.holder);
  count_ended(lease.state);
  Effort& known = effort(holder, job);
  known.gave_back.reset();
  // Samples that others have delivered, or leases that it could not hold, are no lack of progress.
  if (lease.state == LeaseState::kReturned) {
    known.gave_back = now_;
  } else {
    known.no_progress_since = now_;
  }
  forget_held(holder, lease.id);
}

void Scheduler::forget_held(Worker& holder, LeaseId lease) {
  std::erase_if(holder.leases, [&](const HeldLease& held) { return held.id == lease; });
  live_leases_.erase(lease);
  lost_leases_.insert(holder.info.id);
  registry_.count_activity(holder);
  progressed_workers_.insert(holder.info.id);
  waiting_.update(holder);
}

void Scheduler::count_ended(LeaseState state) {
  ++counts_.ended_leases[static_cast<std::size_t>(state)];
}

void Scheduler::forget_emptied(const Job& job, const std::vector<Lease>& leases) {
  for (const Lease& lease : leases) {
    forget_lease(job, lease);
    // Another worker may take its place.
    if (job.policy().max_workers > 0 && !job.is_holder(lease.holder)) work_appeared_ = true;
  }
}

}  // namespace tessera::scheduler
