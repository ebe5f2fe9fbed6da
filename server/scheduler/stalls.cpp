// Workers that are heard of and deliver nothing: no lease is held for ever, and no samples keep one worker
// after the other.
#include <fmt/format.h>

#include <set>
#include <string>
#include <vector>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {
namespace {

long whole_seconds(Duration time) {
  return static_cast<long>(std::chrono::ceil<std::chrono::seconds>(time).count());
}

std::string describe(const WorkItem& item) {
  return fmt::format("samples [{}, {}) of tile {}", item.samples.begin, item.samples.end, item.tile);
}

}  // namespace

void Scheduler::end_stalled_leases(Worker& worker, Actions& actions) {
  const std::set<JobId> stalled = stalled_jobs(worker);
  if (stalled.empty()) return;
  worker.stuck = what_keeps(worker, stalled);
  for (const JobId& job : stalled) stall(worker, job, actions);
  if (worker.stuck) {
    // Whatever else it holds would wait for nothing.
    for (const HeldLease& held : std::vector<HeldLease>(worker.leases))
      end_lease(*find(held.job), held.id, LeaseState::kStalled);
    blame_what_keeps(worker, actions);
  }
  for (const JobId& job : stalled) give_up_if_nobody_gets_on(*find(job), actions);
}

void Scheduler::give_up_if_nobody_gets_on(Job& job, Actions& actions) {
  if (!may_become(job.state(), JobState::kFailed)) return;
  if (const auto failure = job.nobody_gets_on()) fail(job, *failure, actions);
}

std::set<JobId> Scheduler::stalled_jobs(const Worker& worker) const {
  std::set<JobId> stalled;
  for (const HeldLease& held : worker.leases) {
    const Duration in_vain = now_ - worker.efforts.at(held.job).in_vain_since;
    const bool too_long = in_vain >= patience(options_.lease_duration, 0) &&
                          in_vain >= patience(options_.lease_duration, expected_seconds(worker));
    if (too_long) stalled.insert(held.job);
  }
  return stalled;
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

std::optional<Stuck> Scheduler::what_keeps(const Worker& worker, const std::set<JobId>& stalled) const {
  if (worker.rendering == LeaseId{}) return std::nullopt;
  Stuck stuck{.lease = worker.rendering, .since = worker.rendering_since};
  for (const HeldLease& held : worker.leases) {
    if (held.id != worker.rendering) continue;
    // It is well, and at something else.
    if (!stalled.contains(held.job)) return std::nullopt;
    stuck.job = held.job;
    stuck.since = std::max(stuck.since, worker.efforts.at(held.job).in_vain_since);
    // Items are rendered in their order.
    stuck.item = find(held.job)->find_lease(held.id)->items.front();
  }
  // Nobody can tell one that is broken, or very slow, from one that is kept; but who has delivered is
  // neither, and what is honest takes no hour.
  stuck.counts_after =
      roster_.has_shown(worker.info.name)
          ? patience(options_.lease_duration, expected_seconds(worker))
          : std::max(patience(options_.lease_duration, 0),
                     longest_patience(options_.lease_duration) - roster_.was_kept(worker.info.name));
  return stuck;
}

void Scheduler::stall(Worker& worker, const JobId& id, Actions& actions) {
  Job& job = *find(id);
  const Duration in_vain = now_ - worker.efforts.at(id).in_vain_since;
  std::string items;
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases)) {
    if (held.job != id) continue;
    const WorkItem first = end_lease(job, held.id, LeaseState::kStalled).items.front();
    if (items.empty()) items = describe(first);
  }
  const Duration barred = bar(worker, id, in_vain);
  const std::string until =
      worker.stuck ? "nothing until it says that it is through with that"
      : barred > Duration{0}
          ? fmt::format("no more of this job for {} s, or until it delivers", whole_seconds(barred))
          : "no more of this job until it has the files of its scene";
  actions.stalled.push_back(
      fmt::format("worker {} ({}) is heard of, but has delivered nothing of job {} for {} s, where {} came "
                  "first: others have that now, and it is given {}",
                  worker.info.name, worker.info.id.value, id.value, whole_seconds(in_vain), items, until));
}

// One that is fetching a large scene is well; but it may say so for ever. Where nothing of a worker was ever
// counted, nobody knows whether it is slow.
Duration Scheduler::bar(Worker& worker, const JobId& job, Duration in_vain) {
  Effort& effort = worker.efforts.at(job);
  ++effort.stalls;
  if (worker.fetching.contains(job) && !effort.excused) {
    effort.excused = true;
    return {};
  }
  const Duration length = bar_after(in_vain, worker.samples_accepted > 0 ? effort.faults : 0);
  ++effort.faults;
  effort.barred_until = now_ + length;
  return length;
}

bool Scheduler::may_take(const Worker& worker, const Job& job) const {
  return job.may_be_leased_to(worker.info.id) && !worker.is_barred(job.id(), now_) &&
         !worker.awaits_files(job.id());
}

void Scheduler::look_after_stuck(Worker& worker, Actions& actions) {
  if (!worker.stuck) return;
  if (worker.rendering == worker.stuck->lease) return blame_what_keeps(worker, actions);
  // It was slow.
  if (Job* const job = find(worker.stuck->job)) job->absolve(worker.info.id, LossKind::kStuck);
  worker.stuck.reset();
}

void Scheduler::blame_what_keeps(Worker& worker, Actions& actions) {
  Stuck& stuck = *worker.stuck;
  if (stuck.blamed || now_ - stuck.since < stuck.counts_after) return;
  stuck.blamed = true;
  roster_.has_to_show_again(worker.info.name);
  Job* const job = find(stuck.job);
  if (!stuck.item || job == nullptr || !may_become(job->state(), JobState::kFailed)) return;
  const auto failure = job->blame(*stuck.item, {worker.info.id, worker.info.name, LossKind::kStuck});
  if (failure) return fail(*job, *failure, actions);
  give_up_if_nobody_gets_on(*job, actions);
}

}  // namespace tessera::scheduler
