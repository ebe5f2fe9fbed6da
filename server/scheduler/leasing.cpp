// SPDX-License-Identifier: Apache-2.0
// Leases: renews, adopts, grants and ends them.
#include <algorithm>
#include <utility>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {
namespace {

// How late the scheduler may be called after a lease's expiry and still presume its holder dead.
constexpr Duration kPunctuality = std::chrono::seconds(1);

}  // namespace

Worker* Scheduler::on(const Synchronize& event, Actions& actions) {
  withdraw_strikes_if_lost(event.worker.id);
  Worker& worker = registry_.heartbeat(event, now_);
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

void Scheduler::settle_reported(Worker& worker) {
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases)) {
    // The worker has dropped leases that it reported before and does not report now. It may not have received
    // leases that it never reported.
    Job& job = *find(held.job);
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
  work_appeared_ = true;
}

void Scheduler::top_up(Worker& worker) {
  while (worker.room() > 0 && grant_free(worker, false)) {
  }
  // Copies are only for workers without other work. Jobs whose scene the worker could not build come last, or
  // it would be given nothing else.
  if (worker.room() <= 0 || !worker.leases.empty()) return;
  if (!grant_copy(worker)) grant_free(worker, true);
}

int Scheduler::sharers(const Job& job) const {
  const int active = registry_.active_count();
  const std::uint32_t most = job.policy().max_workers;
  return most == 0 || most > static_cast<std::uint32_t>(active) ? active : static_cast<int>(most);
}

bool Scheduler::grant_free(Worker& worker, bool also_refused) {
  std::vector<Job*> candidates;
  for (const JobNumber number : running_) {
    Job& job = jobs_.at(number);
    const bool has_work = job.free() > 0 || can_audit(job, worker);
    const bool buildable = also_refused || !has_refused_lately(worker, job);
    if (has_work && buildable && may_take(worker, job)) candidates.push_back(&job);
  }
  if (candidates.empty()) return false;
  Job& job = *candidates[choose_job(snapshots(candidates))];
  const std::uint64_t available = job.free() + job.to_verify();
  const std::uint64_t samples =
      next_lease_samples(options_.sizing, worker.snapshot(job.id()), available, sharers(job));
  Portion portion;
  if (can_audit(job, worker))
    portion = job.next_audits(samples, worker.leases.empty(), worker.producer(), producers_);
  if (portion.items.empty()) portion = job.next_free(samples, worker.leases.empty());
  // Items that must be leased alone wait for the first idle worker.
  if (portion.items.empty()) return false;
  grant(worker, job, std::move(portion));
  return true;
}

// Near the end of a job, the items that have been held for longest are leased a second time, and the first
// result wins.
bool Scheduler::grant_copy(Worker& worker) {
  std::vector<Job*> candidates;
  for (const JobNumber number : running_) {
    Job& job = jobs_.at(number);
    const bool buildable = !has_refused_lately(worker, job);
    const bool has_leases = job.leased() + job.auditing() > 0;
    if (has_leases && buildable && may_take(worker, job)) candidates.push_back(&job);
  }
  while (!candidates.empty()) {
    const std::size_t chosen = choose_job(snapshots(candidates));
    Job& job = *candidates[chosen];
    const std::uint64_t samples =
        next_lease_samples(options_.sizing, worker.snapshot(job.id()), job.leased(), sharers(job));
    Portion portion = job.next_copies(samples);
    if (portion.items.empty()) job.note_no_copies();
    if (portion.items.empty()) portion = audit_copy(job, worker);
    if (!portion.items.empty()) {
      grant(worker, job, std::move(portion));
      return true;
    }
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
  return false;
}

void Scheduler::grant(Worker& worker, Job& job, Portion portion) {
  ++last_lease_id_.value;
  job.last_served = ++servings_;
  charge(job, portion);
  Lease lease{last_lease_id_, worker.info.id, std::move(portion.items), portion.alone};
  if (portion.audit) lease.auditor = producers_.number(worker.producer());
  enter_lease(worker, job, std::move(lease));
}

// A job that was paused or had no work gets no credit: its virtual time continues from that of the others.
void Scheduler::charge(Job& job, const Portion& portion) {
  std::uint64_t samples = 0;
  for (const WorkItem& item : portion.items) samples += job.pixel_samples(item);
  virtual_time_ = std::max(virtual_time_, job.virtual_finish);
  job.virtual_finish = virtual_time_ + static_cast<double>(samples) * cost_of(options_.sizing, job.cost);
}

void Scheduler::enter_lease(Worker& worker, Job& job, Lease lease) {
  Effort& effort = worker.efforts[job.id()];
  const bool resumes = effort.gave_back && now_ - *effort.gave_back < options_.lease_duration;
  if (!resumes && !worker.holds_any_of(job.id())) effort.no_progress_since = now_;
  live_leases_.insert(lease.id);
  worker.leases.push_back({lease.id, job.id(), lease.alone});
  job.lease(std::move(lease));
}

std::vector<JobSnapshot> Scheduler::snapshots(const std::vector<Job*>& jobs) const {
  std::vector<JobSnapshot> snapshots;
  for (const Job* job : jobs) {
    snapshots.push_back(
        {job->policy().priority, std::max(virtual_time_, job->virtual_finish), job->last_served});
  }
  return snapshots;
}

bool Scheduler::has_refused_lately(const Worker& worker, const Job& job) const {
  const auto refused = worker.refused.find(job.id());
  return refused != worker.refused.end() && now_ < refused->second + options_.lease_duration;
}

Lease Scheduler::end_lease(Job& job, LeaseId id, LeaseState to) {
  Lease lease = job.end_lease(id, to);
  forget_lease(job, lease);
  work_appeared_ = true;
  return lease;
}

void Scheduler::end_all_leases(Worker& worker) {
  worker.wanted_leases = 0;
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases))
    end_lease(*find(held.job), held.id, LeaseState::kRevoked);
}

void Scheduler::lose_lease(const Worker& worker, const HeldLease& held, Actions& actions) {
  Job& job = *find(held.job);
  const bool heard_of = worker.reported.contains(held.id);
  const Lease lease = end_lease(job, held.id, LeaseState::kExpired);
  // The death counts against the lease's samples only if the worker had the lease and the scheduler is on
  // time. A lease that it never reported may not have reached it. One that was told with the answer to a
  // result most likely has, and one death alone fails no job. A draining worker was told to stop. If the
  // deadline is long past, the coordinator itself was suspended.
  const bool draining = worker.state() == WorkerState::kDraining;
  if (!heard_of || draining || now_ > registry_.deadline(worker) + kPunctuality) return;
  const auto failure = job.strike(lease, worker.loss(LossKind::kDied), find_principals(job));
  if (failure) fail(job, *failure, actions);
}

void Scheduler::withdraw_strikes_if_lost(const WorkerId& worker) {
  const Worker* const known = registry_.find(worker);
  if (known != nullptr && known->state() != WorkerState::kSilent) return;
  for (auto& [number, job] : jobs_) job.withdraw_strikes(worker, LossKind::kDied);
}

void Scheduler::forget_lease(const Job& job, const Lease& lease) {
  Worker* const holder = registry_.find(lease.holder);
  Effort& effort = holder->efforts[job.id()];
  effort.gave_back.reset();
  // Samples that others have delivered, or leases that it could not hold, are no lack of progress.
  if (lease.state == LeaseState::kReturned) {
    effort.gave_back = now_;
  } else {
    effort.no_progress_since = now_;
  }
  std::erase_if(holder->leases, [&](const HeldLease& held) { return held.id == lease.id; });
  live_leases_.erase(lease.id);
  lost_leases_.insert(lease.holder);
}

void Scheduler::forget_emptied(const Job& job, const std::vector<Lease>& leases) {
  for (const Lease& lease : leases) {
    forget_lease(job, lease);
    // Another worker may take its place.
    if (job.policy().max_workers > 0 && !job.is_holder(lease.holder)) work_appeared_ = true;
  }
}

}  // namespace tessera::scheduler
