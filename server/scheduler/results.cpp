// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/scheduler/changes.hpp"

namespace tessera::scheduler {
namespace {

// Items that were accepted in a tile that the same result dropped are missing as well.
void drop_what_was_dropped(const SubmitResult& event, Actions& actions) {
  for (std::size_t i = 0; i < event.items.size(); ++i) {
    const TileOfJob tile{event.job, event.items[i].tile};
    const auto& dropped = actions.dropped_tiles;
    const bool gone = std::find(dropped.begin(), dropped.end(), tile) != dropped.end();
    if (gone && actions.verdicts[i] == Verdict::kAccepted) actions.verdicts[i] = Verdict::kDropped;
  }
}

}  // namespace

Worker* Results::on(const SubmitResult& event, Actions& actions) {
  Job* const job = farm_.find(event.job);
  if (job == nullptr || !takes_results(job->state())) {
    actions.verdicts.assign(event.items.size(), Verdict::kDropped);
    return nullptr;
  }
  actions.status = validate(*job, event);
  if (!actions.status) return nullptr;

  losses_.withdraw_strikes(event.worker);
  measure(*job, event);
  const Producer producer = auditing_.producer_of(event);
  std::vector<Lease> ended;
  std::vector<Ruling> rulings;
  std::uint64_t accepted_samples = 0, audited_samples = 0;
  for (std::size_t i = 0; i < event.items.size(); ++i) {
    const WorkItem& item = event.items[i];
    if (job->is_audit(event.lease, item)) {
      actions.verdicts.push_back(Verdict::kAudited);
      audited_samples += job->pixel_samples(item);
      if (auto ruling = auditing_.take(*job, event, i)) rulings.push_back(std::move(*ruling));
      continue;
    }
    const bool fits = job->has(item);
    if (fits) spare_others(*job, item, event.worker);
    const bool accepted = fits && job->accept(item, ended);
    actions.verdicts.push_back(accepted ? Verdict::kAccepted : Verdict::kDropped);
    if (!accepted) continue;
    accepted_samples += job->pixel_samples(item);
    job->set_determinism_fingerprint(event.determinism_fingerprint);
    note_producer(*job, item, producer, fingerprint_of(event, i));
  }
  leases_.forget_emptied(*job, ended);
  for (const Ruling& ruling : rulings) auditing_.follow(*job, ruling, actions);
  drop_what_was_dropped(event, actions);

  note_counted(*job, event, accepted_samples, audited_samples, actions);
  const Lease* const lease = job->find_lease(event.lease);
  if (lease != nullptr && lease->holder == event.worker) {
    if (event.lease_finished) leases_.end(*job, event.lease, LeaseState::kReturned);
    if (!event.decline_reason.empty()) note_refusal(*job, event, actions);
  }
  if (farm_.settled(*job) && job->state() == JobState::kRunning) jobs_.become(*job, JobState::kDone, actions);
  Worker* const worker = farm_.registry.find(event.worker);
  if (worker == nullptr) return nullptr;
  leases_.revoke_ended(*worker);
  return takes_with_answer(*worker, event) ? worker : nullptr;
}

// Results of its other leases wait behind this one.
Worker* Results::on(const DeferResult& event, Actions&) {
  Worker* const worker = farm_.registry.find(event.worker);
  if (worker == nullptr || !worker->holds(event.lease)) return nullptr;
  for (const HeldLease& held : worker->leases)
    leases_.effort(*worker, farm_.jobs.at(held.number)).no_progress_since = farm_.now;
  return nullptr;
}

void Results::note_counted(Job& job, const SubmitResult& event, std::uint64_t accepted, std::uint64_t audited,
                           Actions& actions) {
  farm_.counts.accepted_samples += accepted;
  farm_.rate.add(static_cast<double>(accepted), farm_.now);
  job.rate.add(static_cast<double>(accepted), farm_.now);
  Worker* const worker = farm_.registry.find(event.worker);
  if (worker == nullptr) return;
  worker->samples_accepted += accepted;
  worker->rate.add(static_cast<double>(accepted), farm_.now);
  if (accepted + audited == 0) return;
  farm_.step.progressed_workers.insert(event.worker);
  if (worker->has_stalled(job.run())) {
    farm_.step.work_appeared = true;  // for this worker
    job.note_progress(event.worker);
    note_change(actions.changed_workers, event.worker);
  }
  farm_.registry.has_delivered(worker->info.name);
  leases_.effort(*worker, job) = {.no_progress_since = farm_.now};
}

// A worker that holds nothing else is served by its Synchronize: samples that may kill a worker are leased
// only to such workers, and the scheduler must know whether they received them. The same holds for all
// workers if an idle worker waits for samples that have become free.
bool Results::takes_with_answer(const Worker& worker, const SubmitResult& event) const {
  if (!worker.waiting || event.held.empty() || has_lost(worker, event)) return false;
  const bool was_not_told = worker.leases.size() > event.held.size();
  return (worker.room() > 0 || was_not_told) && !(farm_.step.work_appeared && farm_.waiting.any_idle());
}

bool Results::has_lost(const Worker& worker, const SubmitResult& event) {
  const auto is_held = [&](LeaseId id) { return worker.holds(id); };
  const auto is_held_or_ended_by_this = [&](LeaseId id) { return id == event.lease || is_held(id); };
  return worker.shrunk || is_held(event.lease) ||
         !std::all_of(event.held.begin(), event.held.end(), is_held) ||
         !std::all_of(worker.reported.begin(), worker.reported.end(), is_held_or_ended_by_this);
}

void Results::note_producer(Job& job, const WorkItem& item, const Producer& producer,
                            const Fingerprint& fingerprint) {
  Due due = Due::kNo;
  if (chosen_for_audit(farm_.options.audit_share, farm_.options.audit_secret, job.id(), item))
    due = Due::kChosen;
  if (farm_.producers.is_distrusted(producer)) due = Due::kDoubted;
  job.note_producer(item, farm_.producers.number(producer), fingerprint, due);
  if (due != Due::kNo) farm_.step.work_appeared = true;
}

void Results::spare_others(const Job& job, const WorkItem& item, const WorkerId& deliverer) {
  if (job.done(item.tile).intersects(item.samples)) return;  // it will be rejected
  for (const LeaseId id : job.leases().holding(item)) {
    const Lease& lease = *job.leases().find(id);
    if (lease.holder != deliverer) leases_.shorten({lease.holder});
  }
}

core::Status Results::validate_lease(const Job& job, const SubmitResult& event) const {
  const bool never_given = event.lease == LeaseId{} || event.lease > farm_.last_lease_id;
  const Lease* const lease = job.find_lease(event.lease);
  const LeaseToken token =
      lease != nullptr ? lease->token : farm_.options.sign(event.lease, event.worker, event.job);
  const bool proved = event.token == token;
  if (!never_given && proved && (lease == nullptr || lease->holder == event.worker)) return {};
  return core::fail(
      core::ErrorCode::kInvalidArgument,
      fmt::format("lease {} was {}: deliver items for the lease they were rendered for, with its token",
                  event.lease.value, never_given ? "never given" : "not given to this worker"));
}

bool Results::was_extended_before(const Job& job, LeaseId lease, const WorkItem& item) const {
  const bool of_earlier_run = lease.value >> kLeaseCounterBits < farm_.options.epoch;
  return of_earlier_run && job.has_tile(item.tile) && !item.samples.empty() &&
         item.samples.end > job.shape().target(item.tile);
}

core::Status Results::validate(const Job& job, const SubmitResult& event) const {
  if (auto valid = validate_lease(job, event); !valid) return valid;
  for (const WorkItem& item : event.items) {
    if (job.has(item) || was_extended_before(job, event.lease, item)) continue;
    const std::uint32_t target = job.has_tile(item.tile) ? job.shape().target(item.tile) : job.shape().spp;
    return core::fail(
        core::ErrorCode::kInvalidArgument,
        fmt::format("samples [{}, {}) of tile {} are not part of job {}, which has {} tiles and "
                    "samples [0, {}): deliver items as they were leased",
                    item.samples.begin, item.samples.end, item.tile, job.id().value,
                    job.shape().grid().tile_count(), target));
  }
  return {};
}

// Updates the estimates of the worker's speed and the job's cost, also from dropped results.
void Results::measure(Job& job, const SubmitResult& event) {
  Worker* const worker = farm_.registry.find(event.worker);
  if (worker == nullptr) return;
  worker->last_seen = farm_.now;
  std::uint64_t samples = 0;
  double mean_samples = 0;
  for (const WorkItem& item : event.items) {
    samples += job.pixel_samples(item);
    mean_samples += job.mean_samples(item);
  }
  if (samples == 0 || !(event.render_seconds > 0) || !std::isfinite(event.render_seconds)) return;
  JobNotes& known = leases_.notes(*worker, job);
  if (known.mean_speed) job.learn_costs(event.items, *known.mean_speed * event.render_seconds);
  measure_speed(known.speed, static_cast<double>(samples), event.render_seconds);
  measure_speed(known.mean_speed, mean_samples, event.render_seconds);
  learn_cost(job.cost, worker->pace, worker->info.threads,
             event.render_seconds / static_cast<double>(samples));
}

// A worker that cannot build the scene.
void Results::note_refusal(Job& job, const SubmitResult& event, Actions& actions) {
  Worker& worker = *farm_.registry.find(event.worker);
  std::optional<Time>& refused = leases_.notes(worker, job).refused;
  if (refused) worker.refusals.erase({*refused, job.run()});
  refused = farm_.now;
  worker.refusals.insert({farm_.now, job.run()});
  farm_.waiting.update(worker);
  job.note_refuser(event.worker);
  const auto failure =
      job.decline_reason({event.worker, worker.info.name, worker.info.origin}, event.decline_reason,
                         quorum_.are_all_names(job), quorum_.are_all_principals(job));
  if (failure) jobs_.fail(job, *failure, actions);
}

}  // namespace tessera::scheduler
