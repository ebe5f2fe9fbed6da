// SPDX-License-Identifier: Apache-2.0
// What the model's coordinator does besides scheduling: it drains workers, makes them wait while films have
// no memory, replaces tiles that the store has lost, and lets finished jobs leave the scheduler.
#include <algorithm>

#include "tests/simulation/coordinator.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

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
  world_.note(fmt::format("worker {} is drained", chosen->info.id.value));
  drains_.try_emplace(chosen->info.id, 0);
  handle(Drain{chosen->info.id});
}

void Coordinator::undo_drains() {
  const std::map<WorkerId, int> drains = std::exchange(drains_, {});
  if (!drains.empty()) world_.note("drained workers may take leases again");
  for (const auto& [worker, replies] : drains) handle(Drain{worker, false});
}

bool Coordinator::must_drain_anew(const WorkerId& worker) const {
  if (!drains_.contains(worker)) return false;
  const std::vector<WorkerView> known = workers();
  return std::none_of(known.begin(), known.end(),
                      [&](const WorkerView& view) { return view.info.id == worker; });
}

// The first reply after the drain may tell it of leases that it was given before.
void Coordinator::check_drained(const WorkerId& worker, bool has_new) {
  const auto drain = drains_.find(worker);
  if (drain == drains_.end()) return;
  if (has_new && drain->second > 0)
    world_.fail(fmt::format("worker {} is drained, and was given another lease", worker.value));
  ++drain->second;
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
