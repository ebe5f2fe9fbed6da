// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/stalls.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/scheduler/changes.hpp"
#include "server/scheduler/item_text.hpp"

namespace tessera::scheduler {
namespace {

long whole_seconds(Duration time) {
  return static_cast<long>(std::chrono::ceil<std::chrono::seconds>(time).count());
}

// The parts of the items that lie in `piece`.
std::vector<WorkItem> parts_in(const WorkItem& piece, const std::vector<WorkItem>& items) {
  std::vector<WorkItem> parts;
  for (const WorkItem& item : items) {
    const core::SampleRange common{std::max(item.samples.begin, piece.samples.begin),
                                   std::min(item.samples.end, piece.samples.end)};
    if (item.tile == piece.tile && !common.empty()) parts.push_back({item.tile, common});
  }
  return parts;
}

}  // namespace

void Stalls::end_stalled_leases(Worker& worker, Actions& actions) {
  const std::set<JobId> stalled = stalled_jobs(worker);
  if (stalled.empty()) return;
  farm_.registry.set_stuck(worker, what_keeps(worker, stalled));
  for (const JobId& job : stalled) stall(worker, job, actions);
  if (worker.stuck) {
    // The worker cannot make progress on its other leases either.
    for (const HeldLease& held : std::vector<HeldLease>(worker.leases))
      leases_.end(farm_.at(held.number), held.id, LeaseState::kStalled);
    strike_stuck_ranges(worker, actions);
  }
  for (const JobId& job : stalled) give_up_if_nobody_gets_on(*farm_.find(job), actions);
}

void Stalls::give_up_if_nobody_gets_on(Job& job, Actions& actions) {
  if (!may_become(job.state(), JobState::kFailed)) return;
  if (const auto failure = job.nobody_gets_on(quorum_.are_all_principals(job)))
    jobs_.fail(job, *failure, actions);
}

std::set<JobId> Stalls::stalled_jobs(const Worker& worker) const {
  std::set<JobId> stalled;
  for (const HeldLease& held : worker.leases) {
    const Duration without_progress = farm_.now - worker.effort(held.run)->no_progress_since;
    const bool too_long =
        without_progress >= patience(farm_.options.lease_duration, 0) &&
        without_progress >= patience(farm_.options.lease_duration, eligibility_.expected_seconds(worker));
    if (too_long) stalled.insert(held.job);
  }
  return stalled;
}

std::optional<Stuck> Stalls::what_keeps(const Worker& worker, const std::set<JobId>& stalled) const {
  if (!worker.rendering) return std::nullopt;
  Stuck stuck{.rendering = *worker.rendering, .since = worker.rendering_since};
  for (const HeldLease& held : worker.leases) {
    if (held.id != stuck.rendering.lease) continue;
    // It is not stuck, but renders another job.
    if (!stalled.contains(held.job)) return std::nullopt;
    stuck.since = std::max(stuck.since, worker.effort(held.run)->no_progress_since);
    if (held.job == stuck.rendering.job)
      stuck.items = parts_in(stuck.rendering.item, farm_.jobs.at(held.number).find_lease(held.id)->items);
  }
  // A broken or very slow worker cannot be told from one whose samples never end. A worker of this name that
  // has delivered is neither of these, and other samples do not take an hour.
  stuck.counts_after = farm_.registry.has_shown(worker.info.name)
                           ? patience(farm_.options.lease_duration, eligibility_.expected_seconds(worker))
                           : std::max(patience(farm_.options.lease_duration, 0),
                                      longest_patience(farm_.options.lease_duration) -
                                          farm_.registry.was_kept(worker.info.name));
  return stuck;
}

void Stalls::stall(Worker& worker, const JobId& id, Actions& actions) {
  Job& job = *farm_.find(id);
  const Duration without_progress = farm_.now - worker.effort(job.run())->no_progress_since;
  note_change(actions.changed_workers, worker.info.id);
  std::string items;
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases)) {
    if (held.job != id) continue;
    const WorkItem first = leases_.end(job, held.id, LeaseState::kStalled).items.front();
    if (items.empty()) items = describe_item(job.shape().grid(), first);
  }
  const Duration in_cooldown = begin_cooldown(worker, job, without_progress);
  const std::string until =
      worker.stuck ? "nothing until it says that it is through with that"
      : in_cooldown > Duration{0}
          ? fmt::format("no more of this job for {} s, or until it delivers", whole_seconds(in_cooldown))
          : "no more of this job until it has the files of its scene";
  const bool is_kept = worker.stuck && worker.stuck->rendering.job == id && !worker.stuck->items.empty();
  const std::string at =
      is_kept ? "and says that it renders " + describe_item(job.shape().grid(), worker.stuck->items.front())
              : fmt::format("where {} came first", items);
  actions.stalled.push_back(fmt::format(
      "worker {} ({}) sends heartbeats, but has delivered nothing of job {} for {} s, {}: its leases go to "
      "others, and it is given {}",
      worker.info.name, worker.info.id.value, id.value, whole_seconds(without_progress), at, until));
}

// A worker that fetches a large scene is exempt once, since it may report so for ever. Repeated faults raise
// the cooldown only of workers from which samples were accepted: the others may just be slow.
Duration Stalls::begin_cooldown(Worker& worker, Job& job, Duration without_progress) {
  Effort& known = leases_.effort(worker, job);
  ++known.stalls;
  job.note_stalled(worker.info.id);
  if (worker.fetching.contains(job.id()) && !known.exempt) {
    known.exempt = true;
    return {};
  }
  const Duration length = cooldown_after(without_progress, worker.samples_accepted > 0 ? known.faults : 0);
  ++known.faults;
  known.cooldown_until = farm_.now + length;
  return length;
}

void Stalls::look_after_stuck(Worker& worker, Actions& actions) {
  if (!worker.stuck) return;
  const Rendering& before = worker.stuck->rendering;
  Job* const job = farm_.find(before.job);
  const bool is_stuck = worker.rendering == before;
  // The tiles of a deleted job are unknown.
  const bool may_be_stuck = job == nullptr && worker.rendering && worker.rendering->lease == before.lease;
  if (is_stuck || may_be_stuck) return strike_stuck_ranges(worker, actions);
  // It was only slow.
  if (job != nullptr) job->withdraw_strikes(worker.info.id, LossKind::kStuck);
  farm_.registry.set_stuck(worker, std::nullopt);
  note_change(actions.changed_workers, worker.info.id);
}

void Stalls::strike_stuck_ranges(Worker& worker, Actions& actions) {
  Stuck& stuck = *worker.stuck;
  if (stuck.struck || farm_.now - stuck.since < stuck.counts_after) return;
  stuck.struck = true;
  farm_.registry.has_to_show_again(worker.info.name);
  Job* const job = farm_.find(stuck.rendering.job);
  if (job == nullptr || !may_become(job->state(), JobState::kFailed)) return;
  const auto failure =
      job->strike(stuck.items, worker.loss(LossKind::kStuck), quorum_.are_all_principals(*job));
  if (failure) return jobs_.fail(*job, *failure, actions);
  give_up_if_nobody_gets_on(*job, actions);
}

}  // namespace tessera::scheduler
