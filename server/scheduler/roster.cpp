#include "server/scheduler/roster.hpp"

#include <algorithm>

namespace tessera::scheduler {

Time Worker::last_refusal() const {
  Time last = Time::min();
  for (const auto& [job, time] : refused) last = std::max(last, time);
  return last;
}

int Worker::room() const {
  if (holds_alone()) return 0;
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

Worker* Roster::find(const WorkerId& id) {
  const auto found = workers_.find(id);
  return found == workers_.end() ? nullptr : &found->second;
}

const Worker* Roster::find(const WorkerId& id) const {
  const auto found = workers_.find(id);
  return found == workers_.end() ? nullptr : &found->second;
}

Worker& Roster::hear(const Synchronize& event, Time now) {
  const auto [entry, is_new] = workers_.try_emplace(event.worker.id);
  Worker& worker = entry->second;
  if (is_new) {
    worker.arrival = ++arrivals_;
  } else {
    alarms_.erase({alarm(worker), event.worker.id});
    active_count_ -= worker.takes_leases();
  }
  worker.info = event.worker;
  worker.last_seen = worker.last_synchronized = now;
  worker.draining = event.draining;
  worker.silent = false;
  worker.wanted_leases = event.wanted_leases;
  worker.waiting = false;
  worker.reported.clear();
  for (const LeaseDescription& lease : event.held) worker.reported.insert(lease.id);
  active_count_ += worker.takes_leases();
  alarms_.emplace(alarm(worker), event.worker.id);
  return worker;
}

Time Roster::alarm(const Worker& worker) const {
  return worker.last_synchronized + (worker.silent ? forget_after_ : lease_duration_);
}

std::optional<Time> Roster::next_alarm() const {
  return alarms_.empty() ? std::nullopt : std::optional<Time>(alarms_.begin()->first);
}

Worker* Roster::next_silent(Time now) {
  while (!alarms_.empty() && alarms_.begin()->first <= now) {
    const WorkerId id = alarms_.extract(alarms_.begin()).value().second;
    Worker& worker = workers_.at(id);
    if (worker.silent) {
      workers_.erase(id);
      continue;
    }
    active_count_ -= worker.takes_leases();
    worker.silent = true;
    worker.waiting = false;
    alarms_.emplace(alarm(worker), id);
    return &worker;
  }
  return nullptr;
}

}  // namespace tessera::scheduler
