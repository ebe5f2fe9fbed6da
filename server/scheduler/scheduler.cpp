// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/scheduler.hpp"

#include <algorithm>
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

Actions Scheduler::handle(const Event& event, Time now) {
  now_ = std::max(now_, now);
  begin_event();
  Actions actions;
  expire_workers(actions);
  settle_sender(event, actions);
  clear_ended_runs(actions);
  review_jobs(actions);

  Worker* asking = std::visit([&](const auto& e) { return on(e, actions); }, event);
  count_verdicts(actions.verdicts);
  if (asking != nullptr) {
    revoke_ended(*asking);
    top_up(*asking);
  }
  end_hopeless_waits(actions);
  if (asking != nullptr) revoke_ended(*asking);
  const auto* const result = std::get_if<SubmitResult>(&event);
  if (asking != nullptr && result != nullptr && has_lost(*asking, *result)) asking = nullptr;
  if (asking != nullptr) stop_waiting(*asking);
  wake_waiting(actions);
  report_progress(actions);
  if (asking == nullptr) return actions;
  actions.reply = result != nullptr ? reply_with_answer(*asking, *result) : reply_to(*asking);
  if (result == nullptr) tell_to_stop(*asking, *actions.reply);
  return actions;
}

void Scheduler::begin_event() {
  work_appeared_ = false;
  lost_leases_.clear();
  progressed_jobs_.clear();
  progressed_workers_.clear();
  left_ = options_.per_event;
}

void Scheduler::count_verdicts(const std::vector<Verdict>& verdicts) {
  for (const Verdict verdict : verdicts) {
    counts_.accepted_items += verdict == Verdict::kAccepted;
    counts_.audited_items += verdict == Verdict::kAudited;
    counts_.dropped_items += verdict == Verdict::kDropped;
  }
}

void Scheduler::report_progress(Actions& actions) {
  for (const JobNumber number : progressed_jobs_) {
    const auto job = jobs_.find(number);
    if (job == jobs_.end()) continue;  // deleted
    const Progress progress = job->second.progress();
    if (std::exchange(job->second.reported, progress) != progress)
      actions.progressed_jobs.push_back(job->second.id());
  }
  actions.progressed_workers.assign(progressed_workers_.begin(), progressed_workers_.end());
}

void Scheduler::expire_workers(Actions& actions) {
  for (; left_.expired_workers > 0; --left_.expired_workers) {
    Worker* const worker = registry_.next_overdue(now_);
    if (worker == nullptr) return;
    expire(*worker, actions);
  }
}

void Scheduler::expire(Worker& worker, Actions& actions) {
  note_change(actions.changed_workers, worker.info.id);
  stop_waiting(worker);
  if (worker.state() == WorkerState::kSilent) {
    actions.discarded.push_back(registry_.forget(worker));
    return;
  }
  revoke_ended(worker);
  while (!worker.leases.empty()) {
    lose_lease(worker, HeldLease(worker.leases.front()), actions);
    revoke_ended(worker);  // its death may have failed the job of another lease
  }
  registry_.mark_lost(worker);
}

void Scheduler::settle_sender(const Event& event, Actions& actions) {
  const WorkerId* const id = sender_of(event);
  if (id == nullptr) return;
  Worker* worker = registry_.find(*id);
  while (worker != nullptr && registry_.is_overdue(*worker, now_)) {
    expire(*worker, actions);
    worker = registry_.find(*id);
  }
  if (worker != nullptr) revoke_ended(*worker);
}

Worker* Scheduler::on(const Tick&, Actions&) {
  return nullptr;
}

void Scheduler::wake_waiting(Actions& actions) {
  refresh_indexes();
  std::vector<Worker*> woken;
  const auto wake = [&](const WorkerId& id) {
    Worker* const worker = registry_.find(id);
    if (worker == nullptr || !worker->waiting) return;
    stop_waiting(*worker);
    woken.push_back(worker);
  };
  for (const WorkerId& id : lost_leases_) wake(id);
  if (work_appeared_) {
    waiting_.begin_wave();
  } else if (!work_.any_open()) {
    work_.any_limited() ? waiting_.skip_idle() : waiting_.end_wave();
  }
  for (const WorkerId& id : waiting_.next(options_.per_event.woken_workers)) wake(id);
  std::sort(woken.begin(), woken.end(),
            [](const Worker* a, const Worker* b) { return a->rank() < b->rank(); });
  for (const Worker* const worker : woken) actions.wake.push_back(worker->info.id);
}

Reply Scheduler::reply_to(Worker& worker) {
  Reply reply;
  std::set<LeaseId> ids;
  for (const HeldLease& held : worker.leases) {
    reply.leases.push_back({held.id, held.job, jobs_.at(held.number).find_lease(held.id)->items,
                            options_.sign(held.id, worker.info.id, held.job)});
    ids.insert(held.id);
  }
  reply.changed = ids != worker.reported || worker.shrunk;
  worker.shrunk = false;
  reply.heartbeat_timeout = registry_.deadline(worker) - now_;
  if (!reply.changed) let_wait(worker);
  return reply;
}

// The first reply that says so is not delayed. It is repeated, since it may get lost.
void Scheduler::tell_to_stop(Worker& worker, Reply& reply) {
  reply.stop = worker.stop_requested;
  if (!reply.stop || std::exchange(worker.was_told_to_stop, true)) return;
  reply.changed = true;
  stop_waiting(worker);
}

void Scheduler::let_wait(Worker& worker) {
  worker.waiting = true;
  if (worker.room() > 0) {
    waiting_.enter(worker);
  } else {
    waiting_.leave(worker);
  }
}

void Scheduler::stop_waiting(Worker& worker) {
  worker.waiting = false;
  waiting_.leave(worker);
}

// The worker's Synchronize keeps waiting, as if it had reported the leases of this answer.
Reply Scheduler::reply_with_answer(Worker& worker, const SubmitResult& result) {
  worker.reported = {result.held.begin(), result.held.end()};
  Reply reply = reply_to(worker);
  for (const LeaseDescription& lease : reply.leases) worker.reported.insert(lease.id);
  let_wait(worker);
  return reply;
}

}  // namespace tessera::scheduler
