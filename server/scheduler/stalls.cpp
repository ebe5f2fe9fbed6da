// Workers that are heard of and deliver nothing: no lease is held for ever.
#include <fmt/format.h>

#include <set>
#include <string>
#include <vector>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {

void Scheduler::end_stalled_leases(Worker& worker, Actions& actions) {
  std::set<JobId> stalled;
  for (const HeldLease& held : worker.leases) {
    const Duration in_vain = now_ - worker.efforts.at(held.job).in_vain_since;
    const bool too_long = in_vain >= patience(options_.lease_duration, 0) &&
                          in_vain >= patience(options_.lease_duration, expected_seconds(worker));
    if (too_long) stalled.insert(held.job);
  }
  for (const JobId& job : stalled) stall(worker, job, actions);
}

double Scheduler::expected_seconds(const Worker& worker) const {
  double seconds = 0;
  for (const HeldLease& held : worker.leases) {
    const Job& job = *find(held.job);
    const double speed = expected_speed(options_.sizing, worker.snapshot(held.job));
    for (const WorkItem& item : job.find_lease(held.id)->items)
      seconds += static_cast<double>(job.pixel_samples(item)) / speed;
  }
  return seconds;
}

void Scheduler::stall(Worker& worker, const JobId& id, Actions& actions) {
  Job& job = *find(id);
  Effort& effort = worker.efforts.at(id);
  const Duration in_vain = now_ - effort.in_vain_since;
  const Duration bar = bar_after(in_vain, effort.stalls);
  std::string items;
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases)) {
    if (held.job != id) continue;
    const WorkItem first = end_lease(job, held.id, LeaseState::kStalled).items.front();
    if (items.empty())
      items = fmt::format("samples [{}, {}) of tile {}", first.samples.begin, first.samples.end, first.tile);
  }
  effort.barred_until = now_ + bar;
  ++effort.stalls;
  const auto count = [](Duration time) { return std::chrono::ceil<std::chrono::seconds>(time).count(); };
  actions.stalled.push_back(
      fmt::format("worker {} ({}) is heard of, but has delivered nothing of job {} for {} s, where {} came "
                  "first: others have that now, and it is given no more of this job for {} s, or until it "
                  "delivers",
                  worker.info.name, worker.info.id.value, id.value, count(in_vain), items, count(bar)));
}

bool Scheduler::may_take(const Worker& worker, const Job& job) const {
  return job.may_be_leased_to(worker.info.id) && !worker.is_barred(job.id(), now_);
}

}  // namespace tessera::scheduler
