// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/worker_registry.hpp"

#include <algorithm>

#include "server/scheduler/lifecycle.hpp"

namespace tessera::scheduler {

Time Worker::last_refusal() const {
  Time last = Time::min();
  for (const auto& [job, time] : refused) last = std::max(last, time);
  return last;
}

bool Worker::holds_any_of(const JobId& job) const {
  return std::any_of(leases.begin(), leases.end(), [&](const HeldLease& held) { return held.job == job; });
}

bool Worker::holds(LeaseId lease) const {
  return std::any_of(leases.begin(), leases.end(), [&](const HeldLease& held) { return held.id == lease; });
}

bool Worker::has_stalled(const JobId& job) const {
  const auto effort = efforts.find(job);
  return effort != efforts.end() && effort->second.stalls > 0;
}

bool Worker::in_cooldown(const JobId& job, Time now) const {
  return has_stalled(job) && now < efforts.at(job).cooldown_until;
}

int Worker::room() const {
  if (holds_alone() || stuck) return 0;
  return takes_leases() ? std::min(wanted_leases, kMaxLeasesPerWorker) - static_cast<int>(leases.size()) : 0;
}

WorkerSnapshot Worker::snapshot(const JobId& job) const {
  const auto known = speed.find(job);
  return {info.threads, known == speed.end() ? std::nullopt : std::optional<double>(known->second)};
}

void Worker::measure(const JobId& job, std::uint64_t samples, double render_seconds) {
  constexpr double kNewWeight = 0.3;
  const double measured = static_cast<double>(samples) / render_seconds;
  const auto [known, first] = speed.try_emplace(job, measured);
  if (!first) known->second += kNewWeight * (measured - known->second);
}

Worker* WorkerRegistry::find(const WorkerId& id) {
  const auto found = workers_.find(id);
  return found == workers_.end() ? nullptr : &found->second;
}

const Worker* WorkerRegistry::find(const WorkerId& id) const {
  const auto found = workers_.find(id);
  return found == workers_.end() ? nullptr : &found->second;
}

Worker& WorkerRegistry::heartbeat(const Synchronize& event, Time now) {
  const auto [entry, is_new] = workers_.try_emplace(event.worker.id);
  Worker& worker = entry->second;
  if (is_new) {
    worker.sequence = ++next_sequence_;
    active_count_ += worker.takes_leases();
  } else {
    alarms_.erase({alarm(worker), event.worker.id});
  }
  // It may have begun right after its last heartbeat.
  if (event.rendering != worker.rendering) worker.rendering_since = is_new ? now : worker.last_synchronized;
  worker.rendering = event.rendering;
  worker.info = event.worker;
  worker.last_seen = worker.last_synchronized = now;
  become(worker, event.draining ? WorkerState::kDraining : WorkerState::kPresent);
  worker.wanted_leases = event.wanted_leases;
  worker.waiting = false;
  worker.reported.clear();
  for (const LeaseDescription& lease : event.held) worker.reported.insert(lease.id);
  worker.fetching = event.fetching;
  alarms_.emplace(alarm(worker), event.worker.id);
  return worker;
}

void WorkerRegistry::become(Worker& worker, WorkerState to) {
  if (worker.state_ == to) return;
  if (!may_become(worker.state_, to))
    invalid_transition("worker", worker_state_name(worker.state_), worker_state_name(to));
  active_count_ -= worker.takes_leases();
  worker.state_ = to;
  active_count_ += worker.takes_leases();
}

Time WorkerRegistry::alarm(const Worker& worker) const {
  return worker.last_synchronized +
         (worker.state() == WorkerState::kSilent ? forget_after_ : lease_duration_);
}

std::optional<Time> WorkerRegistry::next_alarm() const {
  return alarms_.empty() ? std::nullopt : std::optional<Time>(alarms_.begin()->first);
}

Worker* WorkerRegistry::next_overdue(Time now) {
  while (!alarms_.empty() && alarms_.begin()->first <= now) {
    Worker& worker = workers_.at(alarms_.begin()->second);
    if (worker.state() != WorkerState::kSilent) return &worker;
    become(worker, WorkerState::kForgotten);
    workers_.erase(alarms_.extract(alarms_.begin()).value().second);
  }
  return nullptr;
}

void WorkerRegistry::mark_lost(Worker& worker) {
  if (worker.stuck && !worker.stuck->struck) {
    kept_[worker.info.name] += worker.last_synchronized - worker.stuck->since;
    worker.stuck->since = worker.last_synchronized;
  }
  alarms_.erase({alarm(worker), worker.info.id});
  become(worker, WorkerState::kSilent);
  worker.waiting = false;
  alarms_.emplace(alarm(worker), worker.info.id);
}

}  // namespace tessera::scheduler
