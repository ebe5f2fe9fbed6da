// SPDX-License-Identifier: Apache-2.0
// Views of the scheduler's state, and its invariants.
#include <fmt/format.h>

#include <algorithm>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {
namespace {

JobView view_of(const Job& job, Time now) {
  return {.id = job.id(),
          .shape = job.shape(),
          .priority = job.policy().priority,
          .state = job.state(),
          .failure = job.failure,
          .samples_done = job.done(),
          .samples_total = job.total(),
          .samples_per_second = job.rate.per_second(now),
          .active_workers = static_cast<int>(job.holder_count()),
          .max_workers = job.policy().max_workers,
          .samples_to_verify = job.to_verify()};
}

std::vector<CooldownView> cooldowns_of(const Worker& worker, Time now) {
  std::vector<CooldownView> cooldowns;
  for (const auto& [job, effort] : worker.efforts) {
    const bool fetching = worker.awaits_files(job);
    if (!worker.in_cooldown(job, now) && !fetching) continue;
    cooldowns.push_back({job, std::max(effort.cooldown_until - now, Duration::zero()), fetching});
  }
  return cooldowns;
}

WorkerView view_of(const Worker& worker, Time now) {
  return {.info = worker.info,
          .held_leases = static_cast<int>(worker.leases.size()),
          .samples_per_second = worker.rate.per_second(now),
          .samples_accepted = worker.samples_accepted,
          .last_seen = worker.last_seen,
          .draining = worker.state() == WorkerState::kDraining,
          .silent = worker.state() == WorkerState::kSilent,
          .audited_ranges = worker.audited_ranges,
          .disproved_ranges = worker.disproved_ranges,
          .stuck = worker.stuck.has_value(),
          .cooldowns = cooldowns_of(worker, now)};
}

}  // namespace

std::optional<JobView> Scheduler::job(const JobId& id, Time now) const {
  const Job* const job = find(id);
  return job == nullptr ? std::nullopt : std::optional<JobView>(view_of(*job, now));
}

std::vector<JobView> Scheduler::jobs(Time now) const {
  std::vector<JobView> views;
  for (const auto& [number, job] : jobs_) views.push_back(view_of(job, now));
  return views;
}

std::vector<JobView> Scheduler::jobs(Time now, std::string_view id_prefix, std::size_t most) const {
  std::vector<JobNumber> numbers;
  for (auto job = job_numbers_.lower_bound(JobId{std::string(id_prefix)});
       job != job_numbers_.end() && job->first.value.starts_with(id_prefix); ++job)
    numbers.push_back(job->second);
  std::sort(numbers.begin(), numbers.end());
  const std::size_t first = numbers.size() - std::min(most, numbers.size());
  std::vector<JobView> views;
  for (std::size_t i = first; i < numbers.size(); ++i) views.push_back(view_of(jobs_.at(numbers[i]), now));
  return views;
}

std::vector<WorkerView> Scheduler::workers(Time now) const {
  std::vector<WorkerView> views;
  for (const auto& [id, worker] : registry_.all()) views.push_back(view_of(worker, now));
  return views;
}

std::optional<WorkerView> Scheduler::worker(const WorkerId& id, Time now) const {
  const Worker* const known = registry_.find(id);
  if (known == nullptr) return std::nullopt;
  return view_of(*known, now);
}

const IntervalSet& Scheduler::done(const JobId& id, int tile) const {
  return find(id)->done(tile);
}

std::optional<std::string> Scheduler::check_invariants(CheckDepth depth) const {
  for (const auto& [number, job] : jobs_) {
    if (running_.contains(number) != (job.state() == JobState::kRunning)) {
      return fmt::format("job {} is {} and listed otherwise", job.id().value, job_state_name(job.state()));
    }
    if (const auto wrong = job.check(depth == CheckDepth::kEverySample)) {
      return fmt::format("job {}: {}", job.id().value, *wrong);
    }
  }
  if (const auto wrong = check_workers()) return wrong;
  return check_idle(depth);
}

// No idle worker waits while there is work for it.
std::optional<std::string> Scheduler::check_idle(CheckDepth depth) const {
  for (const auto& [id, worker] : registry_.all()) {
    if (!worker.waiting || worker.room() <= 0 || !worker.leases.empty()) continue;
    for (const JobNumber number : running_) {
      const Job& job = jobs_.at(number);
      // The end of a cooldown wakes nobody.
      if (!may_take(worker, job) || worker.has_stalled(job.id())) continue;
      if (job.free() > 0)
        return fmt::format("worker {} waits, but job {} has free samples", id.value, job.id().value);
      if (can_audit(job, worker))
        return fmt::format("worker {} waits, but could verify samples of job {}", id.value, job.id().value);
      // The expiry of a refusal wakes nobody.
      const bool looks_for_copies = depth == CheckDepth::kEverySample && !worker.refused.contains(job.id());
      if (!looks_for_copies) continue;
      if (job.has_copies_to_give() || !audit_copy(job, worker).items.empty())
        return fmt::format("worker {} waits, but could be given copies of job {}", id.value, job.id().value);
    }
  }
  return std::nullopt;
}

// Every lease of a job is in its holder's entry and vice versa, and silent workers have none.
std::optional<std::string> Scheduler::check_workers() const {
  std::size_t held_by_workers = 0, held_of_jobs = 0;
  int active = 0;
  for (const auto& [number, job] : jobs_) held_of_jobs += job.lease_count();
  for (const auto& [id, worker] : registry_.all()) {
    active += worker.takes_leases();
    held_by_workers += worker.leases.size();
    const bool silent = worker.state() == WorkerState::kSilent;
    if ((silent || worker.stuck) && !worker.leases.empty())
      return fmt::format("worker {} is {}, but holds leases", id.value, silent ? "silent" : "stuck");
    if (!silent && registry_.deadline(worker) <= now_) return fmt::format("worker {} is overdue", id.value);
    if (worker.leases.size() > static_cast<std::size_t>(kMaxLeasesPerWorker)) {
      return fmt::format("worker {} holds {} leases", id.value, worker.leases.size());
    }
    const auto alone = std::count_if(worker.leases.begin(), worker.leases.end(),
                                     [](const HeldLease& held) { return held.alone; });
    if (alone > 0 && worker.leases.size() > 1)
      return fmt::format("worker {} holds more than a lease that must be alone", id.value);
    for (const HeldLease& held : worker.leases) {
      const Job* const job = find(held.job);
      const Lease* const lease = job == nullptr ? nullptr : job->find_lease(held.id);
      if (lease == nullptr || lease->holder != id) {
        return fmt::format("worker {} holds lease {}, which is not its own", id.value, held.id.value);
      }
      if (lease->state == LeaseState::kHeld && !worker.reported.contains(held.id))
        return fmt::format("worker {} does not report lease {}, which is held", id.value, held.id.value);
      if (worker.in_cooldown(held.job, now_))
        return fmt::format("worker {} holds lease {} of a job it is given none of", id.value, held.id.value);
    }
  }
  if (held_by_workers != held_of_jobs || live_leases_.size() != held_of_jobs) {
    return fmt::format("jobs have {} leases, workers {}, and {} are live", held_of_jobs, held_by_workers,
                       live_leases_.size());
  }
  if (active != registry_.active_count()) {
    return fmt::format("{} workers take leases, counted {}", active, registry_.active_count());
  }
  return std::nullopt;
}

}  // namespace tessera::scheduler
