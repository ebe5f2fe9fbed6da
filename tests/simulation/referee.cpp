// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/referee.hpp"

#include <algorithm>

namespace tessera::simulation {

using namespace scheduler;

namespace {

// How late the coordinator may be called when a lease expires.
constexpr double kPunctualitySeconds = 1.0;

std::set<LeaseId> ids_of(const std::vector<LeaseDescription>& leases) {
  std::set<LeaseId> ids;
  for (const LeaseDescription& lease : leases) ids.insert(lease.id);
  return ids;
}

bool overlap(const WorkItem& a, const WorkItem& b) {
  return a.tile == b.tile && a.samples.begin < b.samples.end && b.samples.begin < a.samples.end;
}

bool holds_any(const Reply& reply, const JobId& job, const WorkItem& item) {
  return std::any_of(reply.leases.begin(), reply.leases.end(), [&](const LeaseDescription& lease) {
    return lease.job == job && std::any_of(lease.items.begin(), lease.items.end(),
                                           [&](const WorkItem& held) { return overlap(held, item); });
  });
}

// The transitions of docs/protocol.md.
bool is_drawn(JobState from, JobState to) {
  using enum JobState;
  static const std::set<std::pair<JobState, JobState>> kArrows{
      {kRunning, kPaused}, {kRunning, kDone},     {kRunning, kCancelled}, {kRunning, kFailed},
      {kPaused, kRunning}, {kPaused, kCancelled}, {kPaused, kFailed},     {kDone, kRunning}};
  return kArrows.contains({from, to});
}

}  // namespace

void Referee::restarted(std::uint32_t epoch) {
  states_.clear();
  last_call_.clear();
  last_heard_.clear();
  waiting_.clear();
  woken_.clear();
  held_without_progress_.clear();
  slowest_seconds_.clear();
  began_.reset();
  last_helped_.clear();
  tried_.clear();
  clock_ = {};
  highest_given_ = std::max(highest_given_, std::uint64_t{epoch} << 40);
}

void Referee::parked(const WorkerId& worker, const Reply& reply) {
  waiting_[worker] = reply;
  woken_.erase(worker);
}

void Referee::answered(const WorkerId& worker) {
  waiting_.erase(worker);
  woken_.erase(worker);
}

void Referee::handled(const Event& event, const Actions& actions, Time clock) {
  clock_ = std::max(clock_, clock);
  if (!began_) began_ = clock_;
  const auto begins_anew = [this](const WorkerId& worker) {
    std::erase_if(held_without_progress_, [&](const auto& held) { return held.first.first == worker; });
  };
  if (const auto* dismissed = std::get_if<Dismiss>(&event)) begins_anew(dismissed->worker);
  if (const auto* deferred = std::get_if<DeferResult>(&event)) begins_anew(deferred->worker);
  if (const auto* call = std::get_if<Synchronize>(&event)) {
    if (clock_ - last_heard_[call->worker.id] >= options_.lease_duration) begins_anew(call->worker.id);
    last_call_[call->worker.id] = *call;
    last_heard_[call->worker.id] = clock_;
  }
  const auto* result = std::get_if<SubmitResult>(&event);
  if (result != nullptr && !result->decline_reason.empty()) tried_.insert({result->worker, result->job});
  for (const JobChange& change : actions.job_changes) check_arrow(change);
  for (const Unaudited& given_up : actions.unaudited) check_given_up(given_up.job);
  woken_.insert(actions.wake.begin(), actions.wake.end());
  if (actions.reply && result == nullptr) check_reply(event, *actions.reply);
}

void Referee::told_with_answer(const SubmitResult& event, const Reply& reply) {
  check_reply(event, reply);
}

void Referee::check_arrow(const JobChange& change) {
  const auto known = states_.find(change.id);
  // Restored jobs may change while they are being entered.
  if (known != states_.end() && known->second != change.from) {
    world_.fail(fmt::format("job {} was {} and is said to have been {}", change.id.value,
                            job_state_name(known->second), job_state_name(change.from)));
  }
  if (!is_drawn(change.from, change.to)) {
    world_.fail(fmt::format("job {} went from {} to {}", change.id.value, job_state_name(change.from),
                            job_state_name(change.to)));
  }
  states_[change.id] = change.to;
}

// No worker could have audited it for the whole patience.
void Referee::check_given_up(const JobId& job) const {
  const auto last = last_helped_.find(job);
  const Duration waited = clock_ - (last == last_helped_.end() ? *began_ : last->second);
  if (waited >= options_.audit_patience) return;
  world_.fail(fmt::format("job {} is done without its audits {:.0f} s after somebody was at it", job.value,
                          std::chrono::duration<double>(waited).count()));
}

void Referee::check_reply(const Event& event, const Reply& reply) {
  const auto* call = std::get_if<Synchronize>(&event);
  const auto* result = std::get_if<SubmitResult>(&event);
  const WorkerId& worker = call != nullptr     ? call->worker.id
                           : result != nullptr ? result->worker
                                               : std::get<TopUp>(event).worker;
  const auto last = last_call_.find(worker);
  if (last == last_call_.end()) return world_.fail("a worker that was never heard of has a reply");
  if (reply.heartbeat_timeout != options_.lease_duration - (clock_ - last_heard_[worker]))
    world_.fail(fmt::format("worker {} is told a wrong time", worker.value));

  std::set<LeaseId> reported;
  for (const LeaseDescription& held : last->second.held) {
    reported.insert(held.id);
    if (call != nullptr && held.id.value <= highest_given_) known_.insert({worker, held.id});
  }
  if (result != nullptr) {
    reported = {result->held.begin(), result->held.end()};
    const std::set<LeaseId> told = ids_of(reply.leases);
    if (!std::includes(told.begin(), told.end(), reported.begin(), reported.end()))
      world_.fail(fmt::format("worker {} is to wait, though it has lost leases", worker.value));
  }
  const std::uint64_t highest_before = highest_given_;
  bool has_new = false;
  for (const LeaseDescription& lease : reply.leases) {
    const bool is_new = !known_.contains({worker, lease.id});
    has_new |= is_new;
    check_lease(lease, is_new, highest_before);
    known_.insert({worker, lease.id});
    if (is_new && tried_.insert({worker, lease.job}).second) last_helped_[lease.job] = clock_;
  }
  const int most = std::min(last->second.wanted_leases, kMaxLeasesPerWorker);
  if (has_new && (last->second.draining || static_cast<int>(reply.leases.size()) > std::max(most, 0)))
    world_.fail(fmt::format("worker {} was given more leases than it asked for", worker.value));
  if (ids_of(reply.leases).size() != reply.leases.size())
    world_.fail(fmt::format("worker {} is told of one lease twice", worker.value));
  check_progress(worker, reply);
  if (!reply.changed && ids_of(reply.leases) != reported)
    world_.fail(fmt::format("worker {} is to wait, though its leases have changed", worker.value));
  // Its call keeps waiting, as if it had reported these leases.
  if (result != nullptr) last->second.held = reply.leases;
}

// No worker holds leases of a job for ever without a contribution.
void Referee::check_progress(const WorkerId& worker, const Reply& reply) {
  std::map<JobId, std::vector<WorkItem>> items;
  for (const LeaseDescription& lease : reply.leases)
    items[lease.job].insert(items[lease.job].end(), lease.items.begin(), lease.items.end());
  std::erase_if(held_without_progress_, [&](const auto& held) {
    return held.first.first == worker && !items.contains(held.first.second);
  });
  for (auto& [job, held] : items) {
    const auto known = held_without_progress_.try_emplace({worker, job}, Held{clock_, {}}).first;
    known->second.items = std::move(held);
    if (clock_ - known->second.since > longest_without_progress(worker, reply))
      world_.fail(fmt::format("worker {} holds leases of job {} and has delivered nothing of it for {:.0f} s",
                              worker.value, job.value,
                              std::chrono::duration<double>(clock_ - known->second.since).count()));
  }
}

// Ten lease durations and the time until its next call, or ten times the expected time at its slowest speed
// so far.
Duration Referee::longest_without_progress(const WorkerId& worker, const Reply& reply) const {
  const auto slowest = slowest_seconds_.find(worker);
  double samples = 0;
  for (const LeaseDescription& lease : reply.leases) {
    for (const WorkItem& item : lease.items) samples += films_.at(lease.job).pixel_samples(item);
  }
  const double expected = slowest == slowest_seconds_.end() ? 0 : slowest->second * samples;
  return std::max<Duration>(10 * options_.lease_duration, seconds(10 * expected)) + options_.lease_duration +
         seconds(kPunctualitySeconds);
}

void Referee::note_progress(const SubmitResult& event, const Actions& actions) {
  double samples = 0;
  for (std::size_t i = 0; i < event.items.size(); ++i) {
    samples += films_.at(event.job).pixel_samples(event.items[i]);
    if (actions.verdicts[i] == Verdict::kDropped) continue;
    last_helped_[event.job] = clock_;
    for (auto& [who, held] : held_without_progress_) {
      if (who.second != event.job) continue;
      const bool has_it = std::any_of(held.items.begin(), held.items.end(),
                                      [&](const WorkItem& item) { return overlap(item, event.items[i]); });
      if (has_it || who.first == event.worker) held.since = clock_;
    }
  }
  if (!actions.dropped_tiles.empty()) held_without_progress_.clear();
  if (samples == 0 || !(event.render_seconds > 0) || event.render_seconds > 1e6) return;
  double& slowest = slowest_seconds_[event.worker];
  slowest = std::max(slowest, event.render_seconds / samples);
}

void Referee::check_lease(const LeaseDescription& lease, bool is_new, std::uint64_t highest_before) {
  const auto state = states_.find(lease.job);
  const bool runs = state != states_.end() && state->second == JobState::kRunning;
  const bool may_be_held = runs || (!is_new && state != states_.end() && state->second == JobState::kPaused);
  if (!may_be_held)
    world_.fail(fmt::format("lease {} is of job {}, which does not run", lease.id.value, lease.job.value));
  if (is_new && lease.id.value <= highest_before)
    world_.fail(fmt::format("lease {} was given a second time", lease.id.value));
  highest_given_ = std::max(highest_given_, lease.id.value);
  check_items(lease);
}

void Referee::check_items(const LeaseDescription& lease) {
  const auto film = films_.find(lease.job);
  if (lease.items.empty() || lease.items.size() > kMaxItemsPerLease * 4)
    world_.fail(fmt::format("lease {} has {} items", lease.id.value, lease.items.size()));
  if (film == films_.end()) return;
  for (auto item = lease.items.begin(); item != lease.items.end(); ++item) {
    if (item->samples.empty() || item->tile < 0 || item->tile >= film->second.tile_count())
      world_.fail(fmt::format("lease {} is of samples that are none", lease.id.value));
    // An audit lease covers only samples that are done.
    if (film->second.has_any(*item) && !(audits_ && film->second.has(*item)))
      world_.fail(fmt::format("lease {} is of samples that are done", lease.id.value));
    if (std::any_of(lease.items.begin(), item, [&](const WorkItem& other) { return overlap(other, *item); }))
      world_.fail(fmt::format("lease {} has samples twice", lease.id.value));
  }
}

void Referee::judged(const SubmitResult& event, const Actions& actions) {
  const auto film = films_.find(event.job);
  const auto state = states_.find(event.job);
  if (!actions.status || film == films_.end() || state == states_.end()) return;
  note_progress(event, actions);
  ModelFilm expected = film->second;
  const auto lacks_all = [&](const WorkItem& item) { return expected.add(item); };
  // Its last sample may just have made it done.
  const bool takes = state->second != JobState::kCancelled && state->second != JobState::kFailed;
  for (std::size_t i = 0; i < event.items.size(); ++i) {
    const WorkItem& item = event.items[i];
    const bool accepted = actions.verdicts[i] == Verdict::kAccepted;
    if (actions.verdicts[i] != Verdict::kDropped) note_delivered(event.worker, event.job, item);
    const TileOfJob tile{event.job, item.tile};
    const auto& dropped = actions.dropped_tiles;
    if (std::find(dropped.begin(), dropped.end(), tile) != dropped.end()) continue;
    if (takes && accepted != lacks_all(item)) {
      world_.fail(fmt::format("job {} tile {} samples [{}, {}) are {}", event.job.value, item.tile,
                              item.samples.begin, item.samples.end,
                              accepted ? "counted twice" : "missing, but were dropped"));
    }
    if (!accepted || state->second == JobState::kDone) continue;
    for (const auto& [worker, reply] : waiting_) {
      const bool silent = clock_ >= last_heard_[worker] + options_.lease_duration;
      if (silent || worker == event.worker || !holds_any(reply, event.job, item)) continue;
      if (!woken_.contains(worker))
        world_.fail(
            fmt::format("worker {} is not told that others have rendered what it holds", worker.value));
    }
  }
}

void Referee::counted(const std::vector<JobView>& before, const std::vector<JobView>& after) {
  for (const JobView& now : after) {
    const auto was =
        std::find_if(before.begin(), before.end(), [&](const JobView& job) { return job.id == now.id; });
    const int had = was == before.end() ? 0 : was->active_workers;
    if (now.max_workers == 0 || now.active_workers <= std::max(had, static_cast<int>(now.max_workers)))
      continue;
    world_.fail(fmt::format("job {} may have {} workers, had {} and has {}", now.id.value, now.max_workers,
                            had, now.active_workers));
  }
}

// A worker need not render samples that it has delivered itself, even if they are missing again later.
void Referee::note_delivered(const WorkerId& worker, const JobId& job, const WorkItem& item) {
  const auto waiting = waiting_.find(worker);
  if (waiting == waiting_.end()) return;
  for (LeaseDescription& lease : waiting->second.leases) {
    if (lease.job != job) continue;
    std::vector<WorkItem> rest;
    for (const WorkItem& held : lease.items) {
      IntervalSet samples{held.samples};
      if (held.tile == item.tile) samples.remove(item.samples);
      for (const core::SampleRange& range : samples.ranges()) rest.push_back({held.tile, range});
    }
    lease.items = std::move(rest);
  }
}

void Referee::settled(const Actions& actions, const Scheduler& scheduler, Time clock) {
  for (const JobChange& change : actions.job_changes) {
    const auto view = scheduler.job(change.id, clock);
    if (view && view->state != states_[change.id])
      world_.fail(fmt::format("job {} is in another state than was said", change.id.value));
    if (change.to == JobState::kDone && view && !films_.at(change.id).complete())
      world_.fail(fmt::format("job {} is done, but its film lacks samples", change.id.value));
  }
}

std::uint64_t Referee::samples_in_film(const JobView& job) const {
  const ModelFilm& film = films_.at(job.id);
  std::uint64_t samples = 0;
  for (int tile = 0; tile < film.tile_count(); ++tile)
    samples += film.count(tile) * job.shape.grid().rect(tile).pixel_count();
  return samples;
}

void Referee::look_around(const Scheduler& scheduler, Time clock) {
  const Time now = std::max(clock_, clock);
  for (const WorkerView& worker : scheduler.workers(clock)) {
    const bool overdue =
        now > last_heard_[worker.info.id] + options_.lease_duration + seconds(kPunctualitySeconds);
    if (worker.held_leases > 0 && overdue)
      world_.fail(fmt::format("worker {} is silent and still holds {} leases", worker.info.id.value,
                              worker.held_leases));
    if (worker.held_leases > kMaxLeasesPerWorker)
      world_.fail(fmt::format("worker {} holds {} leases", worker.info.id.value, worker.held_leases));
    if (!(worker.samples_per_second >= 0))
      world_.fail(fmt::format("worker {} has no speed", worker.info.id.value));
  }
  for (const JobView& job : scheduler.jobs(clock)) {
    if (job.samples_done != samples_in_film(job))
      world_.fail(fmt::format("job {} shows {} samples, its film has {}", job.id.value, job.samples_done,
                              samples_in_film(job)));
    if (job.state == JobState::kDone && job.samples_done != job.samples_total)
      world_.fail(fmt::format("job {} is done with {} samples of {}", job.id.value, job.samples_done,
                              job.samples_total));
    const bool rests = job.state != JobState::kRunning && job.state != JobState::kPaused;
    if (rests && job.active_workers > 0)
      world_.fail(fmt::format("job {} is leased after its end", job.id.value));
  }
}

std::string fingerprint(const Scheduler& scheduler, Time clock) {
  std::string text;
  for (const JobView& job : scheduler.jobs(clock)) {
    text += fmt::format("job {} {} of {}x{} {} spp, priority {}, {}: {}; {} of {}, {} workers of {}\n",
                        job.id.value, job.shape.images, job.shape.window.width(), job.shape.window.height(),
                        job.shape.spp, job.priority, job_state_name(job.state), job.failure, job.samples_done,
                        job.samples_total, job.active_workers, job.max_workers);
  }
  for (const WorkerView& worker : scheduler.workers(clock)) {
    text += fmt::format("worker {} holds {}, {} accepted{}{}\n", worker.info.id.value, worker.held_leases,
                        worker.samples_accepted, worker.draining ? ", draining" : "",
                        worker.silent ? ", silent" : "");
  }
  return text;
}

}  // namespace tessera::simulation
