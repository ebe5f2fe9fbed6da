// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/workers.hpp"

#include <utility>

#include "server/scheduler/changes.hpp"

namespace tessera::scheduler {
namespace {

// Null if it is no event of a worker.
const WorkerId* sender_of(const Event& event) {
  return std::visit(
      [](const auto& e) -> const WorkerId* {
        if constexpr (requires { e.worker.id; }) {
          return &e.worker.id;
        } else if constexpr (requires { e.worker; }) {
          return &e.worker;
        } else {
          return nullptr;
        }
      },
      event);
}

}  // namespace

Worker* Workers::on(const Synchronize& event, Actions& actions) {
  losses_.withdraw_strikes(event.worker.id);
  const Worker* const known = farm_.registry.find(event.worker.id);
  const bool drains = event.draining || (known != nullptr && known->drain_requested);
  const bool is_visible = known == nullptr || known->info != event.worker ||
                          known->state() != (drains ? WorkerState::kDraining : WorkerState::kPresent);
  if (is_visible) note_change(actions.changed_workers, event.worker.id);
  Worker& worker = farm_.registry.heartbeat(event, farm_.now);
  farm_.waiting.leave(worker);
  farm_.producers.introduce(worker.producer());
  settle_reported(worker);
  stalls_.look_after_stuck(worker, actions);
  stalls_.end_stalled_leases(worker, actions);
  for (const LeaseDescription& reported : event.held) adopt(worker, reported);
  return &worker;
}

Worker* Workers::on(const TopUp& event, Actions& actions) {
  Worker* const worker = farm_.registry.find(event.worker);
  if (worker == nullptr || worker->state() == WorkerState::kSilent) {
    actions.status = core::fail(core::ErrorCode::kNotFound,
                                "worker " + event.worker.value + " has been silent for too long");
    return nullptr;
  }
  return worker;
}

Worker* Workers::on(const Dismiss& event, Actions& actions) {
  Worker* const worker = farm_.registry.find(event.worker);
  if (worker == nullptr) {
    actions.status = core::fail(core::ErrorCode::kNotFound, "there is no worker " + event.worker.value);
    return nullptr;
  }
  leases_.end_all(*worker);
  if (event.doubt) reviews_.distrust(worker->producer(), actions);
  return nullptr;
}

Worker* Workers::on(const Drain& event, Actions& actions) {
  Worker* const worker = farm_.registry.find(event.worker);
  if (worker == nullptr) {
    actions.status = core::fail(core::ErrorCode::kNotFound, "there is no worker " + event.worker.value);
    return nullptr;
  }
  farm_.registry.request_drain(*worker, event.drain, event.stop);
  note_change(actions.changed_workers, event.worker);
  if (worker->waiting) farm_.waiting.hold(*worker);  // among those that can be given more, or no longer
  if (worker->stop_requested) farm_.step.lost_leases.insert(event.worker);
  farm_.step.work_appeared = true;
  return nullptr;
}

void Workers::settle_reported(Worker& worker) {
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases)) {
    // The worker has dropped leases that it reported before and does not report now. It may not have received
    // leases that it never reported.
    Job& job = farm_.at(held.number);
    if (worker.reported.contains(held.id)) {
      job.acknowledge(held.id);
    } else if (worker.state() == WorkerState::kDraining ||
               job.find_lease(held.id)->state == LeaseState::kHeld) {
      leases_.end(job, held.id, LeaseState::kReturned);
    }
  }
}

// Adopts a lease that this scheduler does not know: one of an earlier run, or of a worker that was lost and
// returns before its samples went to others.
void Workers::adopt(Worker& worker, const LeaseDescription& reported) {
  Job* const job = farm_.find(reported.job);
  if (job == nullptr || !(job->state() == JobState::kRunning || job->state() == JobState::kPaused)) return;
  if (worker.holds_alone() || worker.stuck || !eligibility_.may_take(worker, *job)) return;
  const bool never_given = reported.id == LeaseId{} || reported.id > farm_.last_lease_id;
  if (never_given || farm_.live_leases.contains(reported.id)) return;
  if (static_cast<int>(worker.leases.size()) >= kMaxLeasesPerWorker) return;
  if (reported.token != farm_.options.sign(reported.id, worker.info.id, reported.job)) return;
  std::vector<WorkItem> items = job->free_parts(reported.items);
  if (items.empty()) return;
  Lease lease{reported.id, worker.info.id, std::move(items), false, reported.token};
  lease.state = LeaseState::kHeld;
  leases_.enter(worker, *job, std::move(lease));
  ++farm_.counts.adopted_leases;
  farm_.step.work_appeared = true;
}

void Workers::expire_workers(Actions& actions) {
  for (; farm_.step.left.expired_workers > 0; --farm_.step.left.expired_workers) {
    Worker* const worker = farm_.registry.next_overdue(farm_.now);
    if (worker == nullptr) return;
    expire(*worker, actions);
  }
}

void Workers::expire(Worker& worker, Actions& actions) {
  note_change(actions.changed_workers, worker.info.id);
  farm_.waiting.release(worker);
  if (worker.state() == WorkerState::kSilent) {
    actions.discarded.push_back(farm_.registry.forget(worker));
    return;
  }
  leases_.revoke_ended(worker);
  while (!worker.leases.empty()) {
    losses_.lose_lease(worker, HeldLease(worker.leases.front()), actions);
    leases_.revoke_ended(worker);  // its death may have failed the job of another lease
  }
  farm_.registry.mark_lost(worker);
}

void Workers::settle_sender(const Event& event, Actions& actions) {
  const WorkerId* const id = sender_of(event);
  if (id == nullptr) return;
  Worker* worker = farm_.registry.find(*id);
  while (worker != nullptr && farm_.registry.is_overdue(*worker, farm_.now)) {
    expire(*worker, actions);
    worker = farm_.registry.find(*id);
  }
  if (worker != nullptr) leases_.revoke_ended(*worker);
}

}  // namespace tessera::scheduler
