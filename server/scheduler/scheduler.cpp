// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/scheduler.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace tessera::scheduler {
Scheduler::Scheduler(const Options& options)
    : options_(options),
      last_lease_id_{static_cast<std::uint64_t>(options.epoch) << kLeaseCounterBits},
      registry_(options.lease_duration, options.forget_after) {}

Actions Scheduler::handle(const Event& event, Time now) {
  now_ = std::max(now_, now);
  work_appeared_ = false;
  lost_leases_.clear();
  Actions actions;
  take_leases_of_silent_workers(actions);

  Worker* asking = std::visit([&](const auto& e) { return on(e, actions); }, event);
  if (asking != nullptr) top_up(*asking);
  end_hopeless_waits(actions);
  const auto* const result = std::get_if<SubmitResult>(&event);
  if (asking != nullptr && result != nullptr && has_lost(*asking, *result)) asking = nullptr;
  if (asking != nullptr) asking->waiting = false;
  wake_waiting(actions);
  if (asking == nullptr) return actions;
  actions.reply = result != nullptr ? reply_with_answer(*asking, *result) : reply_to(*asking);
  return actions;
}

void Scheduler::take_leases_of_silent_workers(Actions& actions) {
  while (Worker* const worker = registry_.next_overdue(now_)) {
    idle_waiters_.erase(worker->sequence);
    while (!worker->leases.empty()) lose_lease(*worker, HeldLease(worker->leases.front()), actions);
    registry_.mark_lost(*worker);
  }
}

// Idle workers come first: others would only queue the work. Then workers that have built every scene, or
// that failed to do so longest ago, so that the same ones do not take all places of a limited job. Then the
// order of registration: a range that kills workers so reaches every worker, since restarted ones come last.
bool Scheduler::comes_before(const Worker* a, const Worker* b) {
  const auto rank = [](const Worker& worker) {
    return std::tuple(!worker.leases.empty(), worker.last_refusal(), worker.sequence);
  };
  return rank(*a) < rank(*b);
}

Worker* Scheduler::on(const Tick&, Actions&) {
  return nullptr;
}

void Scheduler::wake_waiting(Actions& actions) {
  std::map<std::uint64_t, WorkerId> asked;
  if (work_appeared_) asked.swap(idle_waiters_);
  for (const WorkerId& id : lost_leases_) {
    if (const Worker* const worker = registry_.find(id)) asked.emplace(worker->sequence, id);
  }
  std::vector<Worker*> workers;
  for (const auto& [sequence, id] : asked) {
    Worker* const worker = registry_.find(id);
    if (worker != nullptr && worker->waiting) workers.push_back(worker);
  }
  std::sort(workers.begin(), workers.end(), comes_before);
  for (Worker* worker : workers) {
    worker->waiting = false;
    actions.wake.push_back(worker->info.id);
  }
}

Reply Scheduler::reply_to(Worker& worker) {
  Reply reply;
  std::set<LeaseId> ids;
  for (const HeldLease& held : worker.leases) {
    reply.leases.push_back({held.id, held.job, find(held.job)->find_lease(held.id)->items,
                            options_.sign(held.id, worker.info.id, held.job)});
    ids.insert(held.id);
  }
  reply.changed = ids != worker.reported || worker.shrunk;
  worker.shrunk = false;
  reply.heartbeat_timeout = registry_.deadline(worker) - now_;
  if (!reply.changed) let_wait(worker);
  return reply;
}

void Scheduler::let_wait(Worker& worker) {
  worker.waiting = true;
  if (worker.room() > 0) {
    idle_waiters_.emplace(worker.sequence, worker.info.id);
  } else {
    idle_waiters_.erase(worker.sequence);  // from an earlier call
  }
}

// The worker's Synchronize keeps waiting, as if it had reported the leases of this answer.
Reply Scheduler::reply_with_answer(Worker& worker, const SubmitResult& result) {
  worker.reported = {result.held.begin(), result.held.end()};
  Reply reply = reply_to(worker);
  for (const LeaseDescription& lease : reply.leases) worker.reported.insert(lease.id);
  let_wait(worker);
  return reply;
}

std::optional<Time> Scheduler::next_deadline() const {
  std::optional<Time> next = registry_.next_alarm();
  for (const JobNumber number : running_) {
    const std::optional<Time> since = jobs_.at(number).unaudited_since;
    if (since) next = std::min(next.value_or(Time::max()), *since + options_.audit_patience);
  }
  return next;
}

}  // namespace tessera::scheduler
