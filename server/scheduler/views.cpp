// SPDX-License-Identifier: Apache-2.0
// Snapshots of the state for callers.
#include "server/scheduler/farm_view.hpp"

#include <algorithm>

#include "server/scheduler/eligibility.hpp"

namespace tessera::scheduler {

Waiting FarmView::waiting_of(const Job& job) const {
  if (job.state() == JobState::kPaused) return Waiting::kPaused;
  if (job.state() != JobState::kRunning || job.settled()) return Waiting::kNo;
  if (job.holder_count() > 0)
    return job.free() > 0 && !job.may_have_another_holder() ? Waiting::kMaxWorkers : Waiting::kNo;
  if (farm_.registry.active_count() == 0)
    return farm_.registry.any_draining() ? Waiting::kDraining : Waiting::kNoWorker;
  if (!farm_.registry.any_active_for(job.shape()))
    return job.shape().has_layers ? Waiting::kNoLayers : Waiting::kNoImages;
  if (job.free() == 0) return Waiting::kVerification;
  return farm_.work.of_higher_priority(job) > 0 ? Waiting::kHigherPriority : Waiting::kTurn;
}

JobView FarmView::job_view(const Job& job, Time now) const {
  const Waiting waiting = waiting_of(job);
  const bool is_queued = job.state() == JobState::kRunning && job.holder_count() == 0 && job.free() > 0;
  const bool is_over = job.state() != JobState::kRunning && job.state() != JobState::kPaused;
  return {.id = job.id(),
          .shape = job.shape(),
          .priority = job.policy().priority,
          .state = job.state(),
          .failure = job.failure,
          .samples_done = job.done(),
          .samples_total = job.total(),
          .samples_per_second = is_over ? 0 : job.rate.per_second(now),
          .active_workers = static_cast<int>(job.holder_count()),
          .max_workers = job.policy().max_workers,
          .samples_to_verify = job.to_verify(),
          .failure_details = job.failure_details,
          .waiting = waiting,
          .queue_position = is_queued ? static_cast<std::uint32_t>(1 + farm_.work.served_before(job)) : 0};
}

LeasePage FarmView::leased_tiles(const JobId& id, const LeaseId& after, std::size_t most) const {
  LeasePage page;
  const Job* const job = farm_.find(id);
  if (job == nullptr) return page;
  const auto& leases = job->leases().all();
  auto next = leases.upper_bound(after);
  for (; next != leases.end() && most > 0; ++next, --most) {
    for (const WorkItem& item : next->second.items) page.tiles.push_back({item.tile, next->second.holder});
    page.last = next->first;
  }
  if (next == leases.end()) page.last.reset();
  return page;
}

std::vector<CooldownView> FarmView::cooldowns_of(const Worker& worker, Time now) const {
  std::vector<CooldownView> cooldowns;
  for (const auto& [run, notes] : worker.notes) {
    const auto number = farm_.runs.find(run);
    if (number == farm_.runs.end() || !notes.effort || !notes.effort->has_stalled()) continue;
    const Job& job = farm_.jobs.at(number->second);
    const bool fetching = Eligibility::awaits_files(worker, job);
    if (!notes.effort->in_cooldown(now) && !fetching) continue;
    cooldowns.push_back({job.id(), std::max(notes.effort->cooldown_until - now, Duration::zero()), fetching});
  }
  std::sort(cooldowns.begin(), cooldowns.end(),
            [](const CooldownView& a, const CooldownView& b) { return a.job < b.job; });
  return cooldowns;
}

WorkerView FarmView::worker_view(const Worker& worker, Time now) const {
  const auto revoked = std::count_if(worker.leases.begin(), worker.leases.end(), [&](const HeldLease& held) {
    return farm_.ended_runs.contains(held.run);
  });
  return {.info = worker.info,
          .held_leases = static_cast<int>(worker.leases.size()) - static_cast<int>(revoked),
          .samples_per_second = worker.rate.per_second(now),
          .samples_accepted = worker.samples_accepted,
          .last_seen = worker.last_seen,
          .draining = worker.state() == WorkerState::kDraining,
          .drain_requested = worker.drain_requested,
          .silent = worker.state() == WorkerState::kSilent,
          .audited_ranges = worker.audited_ranges,
          .disproved_ranges = worker.disproved_ranges,
          .stuck = worker.stuck.has_value(),
          .cooldowns = cooldowns_of(worker, now)};
}

std::optional<JobView> FarmView::job(const JobId& id, Time now) const {
  const Job* const job = farm_.find(id);
  return job == nullptr ? std::nullopt : std::optional<JobView>(job_view(*job, now));
}

std::vector<JobView> FarmView::jobs(Time now) const {
  std::vector<JobView> views;
  for (const auto& [number, job] : farm_.jobs) views.push_back(job_view(job, now));
  return views;
}

std::vector<JobView> FarmView::jobs(Time now, std::string_view id_prefix, std::size_t most) const {
  std::vector<JobNumber> numbers;
  for (auto job = farm_.job_numbers.lower_bound(JobId{std::string(id_prefix)});
       job != farm_.job_numbers.end() && job->first.value.starts_with(id_prefix); ++job)
    numbers.push_back(job->second);
  std::sort(numbers.begin(), numbers.end());
  const std::size_t first = numbers.size() - std::min(most, numbers.size());
  std::vector<JobView> views;
  for (std::size_t i = first; i < numbers.size(); ++i)
    views.push_back(job_view(farm_.jobs.at(numbers[i]), now));
  return views;
}

std::optional<WorkerView> FarmView::worker(const WorkerId& id, Time now) const {
  const Worker* const worker = farm_.registry.find(id);
  return worker == nullptr ? std::nullopt : std::optional<WorkerView>(worker_view(*worker, now));
}

const WorkerInfo* FarmView::worker_info(const WorkerId& id) const {
  const Worker* const worker = farm_.registry.find(id);
  return worker == nullptr ? nullptr : &worker->info;
}

std::vector<WorkerView> FarmView::workers(Time now, const WorkerId& after, std::size_t most) const {
  std::vector<WorkerView> views;
  const auto& all = farm_.registry.all();
  for (auto next = all.upper_bound(after); next != all.end() && views.size() < most; ++next)
    views.push_back(worker_view(next->second, now));
  return views;
}

std::vector<WorkerView> FarmView::workers(Time now) const {
  std::vector<WorkerView> views;
  for (const auto& [id, worker] : farm_.registry.all()) views.push_back(worker_view(worker, now));
  return views;
}

Totals FarmView::totals(Time now) const {
  Totals totals{.workers = farm_.registry.activities(),
                .samples_per_second = farm_.rate.per_second(now),
                .counts = farm_.counts};
  farm_.job_totals.write_to(totals);
  return totals;
}

const IntervalSet& FarmView::done(const JobId& id, int tile) const {
  return farm_.find(id)->done(tile);
}

std::vector<ProducedItem> FarmView::provenance(const JobId& id, int tile) const {
  std::vector<ProducedItem> items;
  for (const LedgerEntry& entry : farm_.find(id)->audits().ledger().of_tile(tile)) {
    items.push_back(
        {{tile, entry.samples}, farm_.producers.at(entry.producer), entry.fingerprint(), entry.due()});
  }
  return items;
}

std::optional<Time> FarmView::next_deadline() const {
  std::optional<Time> next = farm_.registry.next_alarm();
  const auto at_latest = [&](Time time) { next = std::min(next.value_or(time), time); };
  if (const std::optional<Time> deadline = farm_.audit_waits.next_deadline()) at_latest(*deadline);
  const bool has_backlog = farm_.waiting.in_wave() || !farm_.ended_runs.empty() || !farm_.reviews.empty() ||
                           farm_.audit_waits.next_outdated(farm_.workers_version());
  if (has_backlog) at_latest(farm_.now);
  return next;
}

}  // namespace tessera::scheduler
