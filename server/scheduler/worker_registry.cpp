// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/worker_registry.hpp"

#include <algorithm>
#include <utility>

#include "server/scheduler/lifecycle.hpp"

namespace tessera::scheduler {

WaitingRank Worker::rank() const {
  return {!leases.empty(), refusals.empty() ? Time::min() : refusals.rbegin()->first, sequence};
}

WorkerActivity Worker::activity() const {
  if (state_ == WorkerState::kSilent) return WorkerActivity::kSilent;
  if (state_ == WorkerState::kDraining) return WorkerActivity::kDraining;
  if (stuck) return WorkerActivity::kStuck;
  return leases.empty() ? WorkerActivity::kIdle : WorkerActivity::kBusy;
}

bool Worker::holds_any_of(JobNumber job) const {
  return std::any_of(leases.begin(), leases.end(), [&](const HeldLease& held) { return held.number == job; });
}

bool Worker::holds(LeaseId lease) const {
  return std::any_of(leases.begin(), leases.end(), [&](const HeldLease& held) { return held.id == lease; });
}

const Effort* Worker::effort(RunNumber run) const {
  const JobNotes* const known = notes.find(run);
  return known != nullptr && known->effort ? &*known->effort : nullptr;
}

bool Worker::has_stalled(RunNumber run) const {
  const Effort* const known = effort(run);
  return known != nullptr && known->has_stalled();
}

int Worker::room() const {
  if (holds_alone() || stuck) return 0;
  return takes_leases() ? std::min(wanted_leases, kMaxLeasesPerWorker) - static_cast<int>(leases.size()) : 0;
}

WorkerSnapshot Worker::snapshot(RunNumber run) const {
  const JobNotes* const known = notes.find(run);
  if (known == nullptr) return {info.threads, std::nullopt, std::nullopt};
  return {info.threads, known->speed, known->mean_speed};
}

namespace {

void count(std::map<std::string, int>& numbers, const std::string& key, int change) {
  const auto number = numbers.try_emplace(key).first;
  number->second += change;
  if (number->second == 0) numbers.erase(number);
}

}  // namespace

void measure_speed(std::optional<double>& speed, double samples, double render_seconds) {
  constexpr double kNewWeight = 0.3;
  const double measured = samples / render_seconds;
  speed = speed ? *speed + kNewWeight * (measured - *speed) : measured;
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
  } else {
    alarms_.erase({alarm(worker), event.worker.id});
  }
  // It may have begun right after its last heartbeat.
  if (event.rendering != worker.rendering) worker.rendering_since = is_new ? now : worker.last_synchronized;
  worker.rendering = event.rendering;
  worker.info = event.worker;
  worker.last_seen = worker.last_synchronized = now;
  worker.reports_draining = event.draining;
  settle_state(worker);
  count_active(worker);
  worker.wanted_leases = event.wanted_leases;
  worker.waiting = false;
  worker.reported.clear();
  for (const LeaseDescription& lease : event.held) worker.reported.insert(lease.id);
  worker.fetching = event.fetching;
  alarms_.emplace(alarm(worker), event.worker.id);
  count_presence(worker);
  return worker;
}

void WorkerRegistry::become(Worker& worker, WorkerState to) {
  if (worker.state_ == to) return;
  if (!may_become(worker.state_, to))
    invalid_transition("worker", worker_state_name(worker.state_), worker_state_name(to));
  worker.state_ = to;
  count_active(worker);
}

void WorkerRegistry::count_active(Worker& worker) {
  const auto as = worker.takes_leases() ? std::optional(worker.info.capabilities) : std::nullopt;
  const auto before = std::exchange(worker.counted_, as);
  if (before == as) return;
  active_count_ += int{as.has_value()} - int{before.has_value()};
  if (as) ++active_[*as];
  if (before && --active_[*before] == 0) active_.erase(*before);
}

bool WorkerRegistry::any_active_for(const JobShape& job) const {
  return std::any_of(active_.begin(), active_.end(),
                     [&](const auto& entry) { return entry.first.suffice_for(job); });
}

void WorkerRegistry::settle_state(Worker& worker) {
  const bool drains = worker.reports_draining || worker.drain_requested;
  become(worker, drains ? WorkerState::kDraining : WorkerState::kPresent);
}

void WorkerRegistry::request_drain(Worker& worker, bool drain, bool stop) {
  worker.drain_requested = drain;
  worker.stop_requested = drain && stop;
  worker.was_told_to_stop = false;
  if (worker.state() != WorkerState::kSilent) settle_state(worker);
  count_presence(worker);
}

void WorkerRegistry::set_stuck(Worker& worker, std::optional<Stuck> stuck) {
  worker.stuck = std::move(stuck);
  count_presence(worker);
}

void WorkerRegistry::count_activity(Worker& worker) {
  const WorkerActivity now = worker.activity();
  if (now == worker.activity_) return;
  if (worker.activity_) --activities_[static_cast<std::size_t>(*worker.activity_)];
  ++activities_[static_cast<std::size_t>(now)];
  worker.activity_ = now;
}

void WorkerRegistry::count_presence(Worker& worker) {
  count_activity(worker);
  std::optional<Worker::Presence> now;
  if (worker.is_available())
    now = {worker.info.name, worker.info.origin, worker.info.machine, identity_of(worker.producer())};
  if (now == worker.presence_) return;
  ++times_changed_;
  if (const auto& before = worker.presence_) {
    const auto alike = available_.find(before->identity);
    alike->second.erase(worker.info.id);
    if (alike->second.empty()) available_.erase(alike);
    count(names_, before->name, -1);
    count(origins_, before->origin, -1);
  }
  if (now) {
    available_[now->identity].insert(worker.info.id);
    count(names_, now->name, 1);
    count(origins_, now->origin, 1);
  }
  worker.presence_ = std::move(now);
}

Time WorkerRegistry::alarm(const Worker& worker) const {
  return worker.last_synchronized +
         (worker.state() == WorkerState::kSilent ? forget_after_ : lease_duration_);
}

std::optional<Time> WorkerRegistry::next_alarm() const {
  return alarms_.empty() ? std::nullopt : std::optional<Time>(alarms_.begin()->first);
}

Worker* WorkerRegistry::next_overdue(Time now) {
  if (alarms_.empty() || alarms_.begin()->first > now) return nullptr;
  return &workers_.at(alarms_.begin()->second);
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
  count_presence(worker);
}

std::shared_ptr<const void> WorkerRegistry::forget(Worker& worker) {
  alarms_.erase({alarm(worker), worker.info.id});
  --activities_[static_cast<std::size_t>(*worker.activity_)];
  become(worker, WorkerState::kForgotten);
  return std::make_shared<decltype(workers_)::node_type>(workers_.extract(worker.info.id));
}

}  // namespace tessera::scheduler
