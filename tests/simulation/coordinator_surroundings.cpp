// SPDX-License-Identifier: Apache-2.0
// What the model's coordinator does besides scheduling: it drains workers, lifts the quarantine, makes
// workers wait while films have no memory, replaces tiles that the store has lost, and lets finished jobs
// leave the scheduler.
#include <algorithm>

#include "tests/simulation/coordinator.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

constexpr double kTellWithinSeconds = 1;

template <typename View>
const View* any_of(const std::vector<View>& views, Random& random) {
  if (views.empty()) return nullptr;
  return &views[static_cast<std::size_t>(random.integer(0, static_cast<int>(views.size()) - 1))];
}

}  // namespace

// ---- Drains: stored, so that they survive a restart ----

void Coordinator::drain_any(Random& random) {
  const std::vector<WorkerView> known = workers();
  const WorkerView* const chosen = any_of(known, random);
  if (chosen == nullptr) return;
  const bool stop = random.chance(0.4);
  world_.note(fmt::format("worker {} is {}", chosen->info.id.value, stop ? "stopped" : "drained"));
  drains_[chosen->info.id] = {.stop = stop};
  drain(chosen->info.id);
  save_fleet();
}

void Coordinator::drain(const WorkerId& worker) {
  Drained& drained = drains_.at(worker);
  handle(Drain{worker, true, drained.stop});
  drained.is_known = true;
  if (const auto waiting = parked_.find(worker); drained.stop && waiting != parked_.end())
    world_.after(seconds(kTellWithinSeconds), [=, this, run = run_, call = waiting->second.call] {
      if (run == run_) check_told(worker, call);
    });
}

// A worker that waits in a call learns at once that it must stop, but for one that seems to be lost.
void Coordinator::check_told(const WorkerId& worker, std::uint64_t call) {
  const auto drained = drains_.find(worker);
  if (!up() || world_.now() < stalled_until_ || drained == drains_.end() || !drained->second.stop) return;
  const std::vector<WorkerView> known = workers();
  const bool is_heard = std::any_of(known.begin(), known.end(), [&](const WorkerView& view) {
    return view.info.id == worker && !view.silent;
  });
  const auto waiting = parked_.find(worker);
  if (is_heard && waiting != parked_.end() && waiting->second.call == call)
    world_.fail(fmt::format("worker {} must stop, and waits", worker.value));
}

void Coordinator::undo_drains() {
  const std::map<WorkerId, Drained> drains = std::exchange(drains_, {});
  if (!drains.empty()) world_.note("drained workers may take leases again");
  for (const auto& [worker, drained] : drains) handle(Drain{worker, false});
}

bool Coordinator::must_drain_anew(const WorkerId& worker) const {
  if (!drains_.contains(worker)) return false;
  const std::vector<WorkerView> known = workers();
  return std::none_of(known.begin(), known.end(),
                      [&](const WorkerView& view) { return view.info.id == worker; });
}

// The first reply after the drain may tell it of leases that it was given before. Answers to results do not
// say that it must stop.
void Coordinator::check_drained(const WorkerId& worker, const Reply& reply, bool has_new, bool is_answer) {
  const auto drain = drains_.find(worker);
  if (drain == drains_.end()) return;
  Drained& drained = drain->second;
  if (has_new && drained.has_reply)
    world_.fail(fmt::format("worker {} is drained, and was given another lease", worker.value));
  if (drained.stop && drained.is_known && !is_answer && !reply.stop)
    world_.fail(fmt::format("worker {} must stop, and is not told", worker.value));
  drained.has_reply = true;
}

// ---- The quarantine ----

bool Coordinator::lift_any(Random& random) {
  const auto count = static_cast<int>(quarantine_.entries().size());
  if (count == 0) return false;
  for (const Producer& producer : quarantine_.lift(static_cast<std::size_t>(random.integer(0, count - 1)))) {
    world_.note(fmt::format("the quarantine of {} is lifted", called(producer)));
    handle(Trust{producer});
  }
  save_fleet();
  return true;
}

void Coordinator::save_fleet() {
  if (!disk_.refuses()) quarantine_.store();
}

// ---- Films without memory ----

void Coordinator::films_lack_memory(Duration duration) {
  world_.note(
      fmt::format("films have no memory for {:.1f} s", std::chrono::duration<double>(duration).count()));
  lacks_film_memory_until_ = world_.now() + duration;
}

// ---- Lost tiles ----

void Coordinator::lose_a_tile(Random& random) {
  const std::vector<JobView> known = jobs();
  const JobView* const job = any_of(known, random);
  if (job == nullptr) return;
  const int tile = random.integer(0, films_.at(job->id).tile_count() - 1);
  world_.note(fmt::format("the store has lost tile {} of job {}", tile, job->id.value));
  const Actions actions = handle(DropTile{job->id, tile});
  empty_tiles(actions);
  referee_.settled(actions, *scheduler_, clock());
}

// ---- Finished jobs ----

bool Coordinator::is_whole_on_disk(const JobView& job) const {
  const Disk::StoredJob* const stored = disk_.stored(job.id);
  if (stored == nullptr || !is_stored_as(stored->row, job)) return false;
  const ModelFilm& film = films_.at(job.id);
  for (int tile = 0; tile < film.tile_count(); ++tile)
    if (!stored->film.same_tile(tile, film)) return false;
  return true;
}

void Coordinator::release_any(Random& random) {
  const std::vector<JobView> known = jobs();
  const JobView* const job = any_of(known, random);
  if (job == nullptr) return;
  const bool is_open = job->state == JobState::kRunning || job->state == JobState::kPaused;
  if (!is_open && !is_whole_on_disk(*job)) return;
  if (!handle(ReleaseJob{job->id}).status) return;
  world_.note(fmt::format("job {} leaves the scheduler", job->id.value));
  if (is_open) world_.fail(fmt::format("job {} has left before its end", job->id.value));
  films_.erase(job->id);
  referee_.deleted(job->id);
  released_.insert(job->id);
}

void Coordinator::bring_back(const JobId& job) {
  if (released_.erase(job) > 0) restore(*disk_.stored(job));
}

}  // namespace tessera::simulation
