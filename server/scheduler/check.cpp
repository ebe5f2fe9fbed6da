// SPDX-License-Identifier: Apache-2.0
// The scheduler's invariants.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "server/scheduler/auditors.hpp"
#include "server/scheduler/check.hpp"

namespace tessera::scheduler {

std::optional<std::string> Invariants::check(CheckDepth depth) const {
  CheckCursor cursor;
  if (const auto wrong = check_some(cursor, std::numeric_limits<std::size_t>::max())) return wrong;
  if (const auto wrong = check_sums()) return wrong;
  if (depth == CheckDepth::kCounters) return std::nullopt;
  for (const auto& [number, job] : farm_.jobs) {
    if (const auto wrong = job.check_samples()) return fmt::format("job {}: {}", job.id().value, *wrong);
  }
  for (const auto& [id, worker] : farm_.registry.all()) {
    if (const auto wrong = check_every_job(worker)) return wrong;
    if (const auto wrong = check_choice(worker)) return wrong;
  }
  return std::nullopt;
}

std::optional<std::string> Invariants::check_some(CheckCursor& cursor, std::size_t most) const {
  while (most > 0) {
    if (const auto wrong = check_next(cursor, most)) return wrong;
  }
  return std::nullopt;
}

// Checks a job, leases of a job, or workers; lowers `left` by their number, and to 0 at the end of a round.
std::optional<std::string> Invariants::check_next(CheckCursor& cursor, std::size_t& left) const {
  using enum CheckCursor::Of;
  if (cursor.of == kWorkers) return check_workers(cursor, left);
  const auto job = farm_.jobs.lower_bound(cursor.job);
  if (job == farm_.jobs.end()) {
    cursor.of = kWorkers;
    return std::nullopt;
  }
  if (cursor.of != kJobs && job->first == cursor.job) return check_leases(job->second, cursor, left);
  --left;
  cursor.of = kLeases;
  cursor.job = job->first;
  cursor.lease = {};
  return check_job(job->second);
}

std::optional<std::string> Invariants::check_leases(const Job& job, CheckCursor& cursor,
                                                    std::size_t& left) const {
  using enum CheckCursor::Of;
  const auto& leases = (cursor.of == kLeases ? job.leases() : job.audit_leases()).all();
  for (auto next = leases.upper_bound(cursor.lease); next != leases.end(); ++next) {
    if (left == 0) return std::nullopt;
    --left;
    cursor.lease = next->first;
    if (const auto wrong = check_lease(job, next->second)) return wrong;
  }
  cursor.job += cursor.of == kAudits ? 1 : 0;
  cursor.of = cursor.of == kLeases ? kAudits : kJobs;
  cursor.lease = {};
  return std::nullopt;
}

std::optional<std::string> Invariants::check_workers(CheckCursor& cursor, std::size_t& left) const {
  for (auto next = farm_.registry.all().lower_bound(cursor.worker); next != farm_.registry.all().end();
       ++next) {
    if (left == 0) return std::nullopt;
    --left;
    cursor.worker.value = next->first.value + '\0';  // the next possible id
    if (const auto wrong = check_worker(next->second)) return wrong;
  }
  const std::uint64_t rounds = cursor.rounds + 1;
  cursor = {};
  cursor.rounds = rounds;
  left = 0;
  return std::nullopt;
}

std::optional<std::string> Invariants::check_job(const Job& job) const {
  const auto wrong = [&](const std::string& what) {
    return std::optional(fmt::format("job {}: {}", job.id().value, what));
  };
  if (const auto broken = job.check()) return wrong(*broken);
  const bool reviewed = !farm_.reviews.contains(job.number());
  if (job.state() == JobState::kDone && reviewed && job.to_verify() > 0)
    return wrong(fmt::format("done, but has {} samples to verify", job.to_verify()));
  if (job.state() == JobState::kRunning && farm_.settled(job)) return wrong("lacks nothing, but is not done");
  const auto run = farm_.runs.find(job.run());
  if (run == farm_.runs.end() || run->second != job.number()) return wrong("its run is not listed");
  if (farm_.work.entry_of(job.number()) != WorkIndex::entry_for(job, farm_.producers))
    return wrong(fmt::format("{}, and its work is listed otherwise", job_state_name(job.state())));
  if (!farm_.job_totals.counts(job.number(), JobTotals::share_of(job)))
    return wrong("is not counted as it is");
  if (farm_.audit_waits.contains(job.number()) != lacks_only_lots(job))
    return wrong("waits for auditors, and is listed otherwise");
  if (farm_.unattended.contains(job.number()) != is_unattended(job))
    return wrong("has samples that nobody verifies, and is listed otherwise");
  return std::nullopt;
}

std::optional<std::string> Invariants::check_lease(const Job& job, const Lease& lease) const {
  if (const auto broken = job.check_lease(lease)) return fmt::format("job {}: {}", job.id().value, *broken);
  const Worker* const holder = farm_.registry.find(lease.holder);
  if (holder == nullptr || !holder->holds(lease.id) || !farm_.live_leases.contains(lease.id))
    return fmt::format("job {}: lease {} is not in its holder's entry", job.id().value, lease.id.value);
  if (lease.token != farm_.options.sign(lease.id, lease.holder, job.id()))
    return fmt::format("job {}: lease {} has the token of another", job.id().value, lease.id.value);
  return std::nullopt;
}

// Every lease in a worker's entry is its own, and silent workers have none.
std::optional<std::string> Invariants::check_worker(const Worker& worker) const {
  const std::string& id = worker.info.id.value;
  const bool silent = worker.state() == WorkerState::kSilent;
  if ((silent || worker.stuck) && !worker.leases.empty())
    return fmt::format("worker {} is {}, but holds leases", id, silent ? "silent" : "stuck");
  const bool has_been_expired = farm_.step.left.expired_workers > 0;
  if (!silent && has_been_expired && farm_.registry.deadline(worker) <= farm_.now)
    return fmt::format("worker {} is overdue", id);
  if (worker.leases.size() > static_cast<std::size_t>(kMaxLeasesPerWorker))
    return fmt::format("worker {} holds {} leases", id, worker.leases.size());
  const bool any_alone = std::any_of(worker.leases.begin(), worker.leases.end(),
                                     [](const HeldLease& held) { return held.alone; });
  if (any_alone && worker.leases.size() > 1)
    return fmt::format("worker {} holds more than a lease that must be alone", id);
  for (const HeldLease& held : worker.leases) {
    if (const auto wrong = check_held(worker, held)) return wrong;
  }
  const bool can_be_woken = worker.waiting && worker.room() > 0;
  if (worker.waiting_rank ? *worker.waiting_rank != worker.rank() || !worker.waiting : can_be_woken)
    return fmt::format("worker {} {}, and is listed otherwise", id,
                       worker.waiting ? "waits" : "does not wait");
  return check_idle(worker);
}

std::optional<std::string> Invariants::check_held(const Worker& worker, const HeldLease& held) const {
  const std::string& id = worker.info.id.value;
  if (farm_.ended_runs.contains(held.run)) return std::nullopt;
  const auto job = farm_.jobs.find(held.number);
  const Lease* const lease = job == farm_.jobs.end() ? nullptr : job->second.find_lease(held.id);
  if (lease == nullptr || lease->holder != worker.info.id)
    return fmt::format("worker {} holds lease {}, which is not its own", id, held.id.value);
  if (lease->state == LeaseState::kHeld && !worker.reported.contains(held.id))
    return fmt::format("worker {} does not report lease {}, which is held", id, held.id.value);
  const Effort* const effort = worker.effort(held.run);
  if (effort == nullptr || effort->in_cooldown(farm_.now))
    return fmt::format("worker {} holds lease {} of a job it is given none of", id, held.id.value);
  return std::nullopt;
}

// No idle worker waits while there is work for it. The end of a cooldown wakes nobody.
std::optional<std::string> Invariants::check_idle(const Worker& worker) const {
  const bool is_idle = worker.waiting && worker.room() > 0 && worker.leases.empty();
  if (!is_idle || farm_.waiting.in_wave()) return std::nullopt;
  const auto takes = [&](JobNumber number) {
    const Job& job = farm_.jobs.at(number);
    return eligibility_.may_take(worker, job) && !worker.has_stalled(job.run());
  };
  const auto audits = [&](JobNumber number) {
    return takes(number) && eligibility_.can_audit(farm_.jobs.at(number), worker);
  };
  std::optional<JobNumber> job = farm_.work.free().first(farm_.virtual_time, kNoIdentity, takes);
  const IdentityNumber identity = farm_.producers.identity(worker.producer());
  if (!job && !farm_.producers.is_distrusted(worker.producer()))
    job = farm_.work.audits().first(farm_.virtual_time, identity, audits);
  if (!job) return std::nullopt;
  return fmt::format("worker {} waits, but job {} has {}", worker.info.id.value,
                     farm_.jobs.at(*job).id().value,
                     farm_.jobs.at(*job).free() > 0 ? "free samples" : "samples that it could verify");
}

std::optional<std::string> Invariants::check_sums() const {
  std::size_t held_by_workers = 0, held_of_jobs = 0;
  std::map<Capabilities, int> active;
  Totals counted;
  for (const auto& [number, job] : farm_.jobs) {
    held_of_jobs += job.lease_count();
    ++counted.jobs[static_cast<std::size_t>(job.state())];
  }
  for (const auto& [run, ended] : farm_.ended_runs)
    held_of_jobs += ended.leases.all().size() + ended.audit_leases.all().size();
  for (const auto& [id, worker] : farm_.registry.all()) {
    if (worker.takes_leases()) ++active[worker.info.capabilities];
    ++counted.workers[static_cast<std::size_t>(worker.activity())];
    held_by_workers += worker.leases.size();
  }
  if (held_by_workers != held_of_jobs || farm_.live_leases.size() != held_of_jobs) {
    return fmt::format("jobs have {} leases, workers {}, and {} are live", held_of_jobs, held_by_workers,
                       farm_.live_leases.size());
  }
  if (active != farm_.registry.active_by_capabilities())
    return "the workers that take leases are counted wrongly";
  Totals kept;
  kept.workers = farm_.registry.activities();
  farm_.job_totals.write_to(kept);
  if (kept.jobs != counted.jobs || kept.workers != counted.workers)
    return "the totals of jobs by state or workers by activity are wrong";
  return std::nullopt;
}

// Like check_idle(), but looks at every job, and for copies as well.
std::optional<std::string> Invariants::check_every_job(const Worker& worker) const {
  if (!worker.waiting || worker.room() <= 0 || !worker.leases.empty() || farm_.waiting.in_wave())
    return std::nullopt;
  const std::string& id = worker.info.id.value;
  for (const auto& [number, job] : farm_.jobs) {
    if (job.state() != JobState::kRunning || !eligibility_.may_take(worker, job) ||
        worker.has_stalled(job.run()))
      continue;
    if (job.free() > 0)
      return fmt::format("worker {} waits, but job {} has free samples", id, job.id().value);
    if (eligibility_.can_audit(job, worker))
      return fmt::format("worker {} waits, but could verify samples of job {}", id, job.id().value);
    // The expiry of a refusal wakes nobody.
    const JobNotes* const notes = worker.notes.find(job.run());
    if (notes != nullptr && notes->refused) continue;
    if (job.has_copies_to_give() || !eligibility_.audit_copy(job, worker).items.empty())
      return fmt::format("worker {} waits, but could be given copies of job {}", id, job.id().value);
  }
  return std::nullopt;
}

// The indexes choose the job that choose_job() chooses of all.
std::optional<std::string> Invariants::check_choice(const Worker& worker) const {
  for (const bool also_refused : {false, true}) {
    const auto by_index = eligibility_.chosen(worker, also_refused),
               of_all = chosen_of_all(worker, also_refused);
    if (by_index != of_all)
      return fmt::format("worker {} is given leases of job {} (0: none) instead of {}", worker.info.id.value,
                         by_index.value_or(0), of_all.value_or(0));
  }
  return std::nullopt;
}

std::optional<JobNumber> Invariants::chosen_of_all(const Worker& worker, bool also_refused) const {
  std::vector<JobNumber> candidates;
  for (const auto& [number, job] : farm_.jobs) {
    const bool has_work =
        job.state() == JobState::kRunning && (job.free() > 0 || eligibility_.can_audit(job, worker));
    if (has_work && eligibility_.can_be_given(worker, job, also_refused)) candidates.push_back(number);
  }
  if (candidates.empty()) return std::nullopt;
  return candidates[choose_job(eligibility_.snapshots(candidates))];
}

std::optional<std::string> FarmView::check_invariants(CheckDepth depth) const {
  return Invariants(farm_).check(depth);
}

std::optional<std::string> FarmView::check_some(CheckCursor& cursor, std::size_t most) const {
  return Invariants(farm_).check_some(cursor, most);
}

}  // namespace tessera::scheduler
