// SPDX-License-Identifier: Apache-2.0
// Checkpoints of the model's coordinator: job rows are copied first and written last, and tiles are written
// in batches in between. A crash or a write error may come between any two writes.
#include <algorithm>
#include <utility>

#include "tests/simulation/coordinator.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

// The time between two checkpoints. With the longest checkpoint before and after it, the sum stays below
// kPromisedSeconds.
constexpr double kPauseSeconds = 1.0;
constexpr double kLongestCheckpointSeconds = 0.45;
constexpr std::size_t kTilesPerBatch = 6;

}  // namespace

JobRow Coordinator::row_of(const JobId& id) {
  const JobView view = *scheduler_->job(id, clock());
  return {view.shape, view.priority, view.max_workers, view.state, view.failure, ++revisions_};
}

void Coordinator::checkpoint(std::uint64_t run) {
  if (!up() || run != run_) return;
  save_fleet();
  Checkpoint checkpoint;
  for (const Disk::StoredJob& job : disk_.jobs()) {
    if (released_.contains(job.id)) continue;
    checkpoint.rows.emplace_back(job.id, row_of(job.id));
    const ModelFilm& film = films_.at(job.id);
    for (int tile = 0; tile < film.tile_count(); ++tile) {
      const auto provenance = job.provenance.find(tile);
      const bool same_authors =
          (provenance == job.provenance.end() ? std::vector<ProducedItem>{} : provenance->second) ==
          scheduler_->provenance(job.id, tile);
      if (!job.film.same_tile(tile, film) || !same_authors) checkpoint.tiles.emplace_back(job.id, tile);
    }
  }
  const std::size_t batches = checkpoint.tiles.size() / kTilesPerBatch + 1;
  if (world_.random.chance(0.3)) {
    checkpoint.batch_seconds =
        world_.random.real(0, kLongestCheckpointSeconds) / static_cast<double>(batches);
  }
  write_some(run, std::move(checkpoint));
}

void Coordinator::write_some(std::uint64_t run, Checkpoint checkpoint) {
  if (!up() || run != run_) return;
  const auto again = [=, this] { this->checkpoint(run); };
  while (checkpoint.written < checkpoint.tiles.size()) {
    if (!write_tiles(checkpoint)) return world_.after(seconds(kPauseSeconds), again);
    if (checkpoint.batch_seconds == 0) continue;
    return world_.after(seconds(checkpoint.batch_seconds), [=, this] { write_some(run, checkpoint); });
  }
  finish(checkpoint);
  world_.after(seconds(kPauseSeconds), again);
}

bool Coordinator::write_tiles(Checkpoint& checkpoint) {
  const std::size_t end = std::min(checkpoint.written + kTilesPerBatch, checkpoint.tiles.size());
  for (; checkpoint.written < end; ++checkpoint.written) {
    const auto& [id, tile] = checkpoint.tiles[checkpoint.written];
    const auto film = films_.find(id);
    if (film == films_.end()) continue;  // deleted meanwhile
    compare(id, tile);
    if (!disk_.write_tile(id, tile, film->second, scheduler_->provenance(id, tile))) return false;
  }
  return true;
}

void Coordinator::finish(const Checkpoint& checkpoint) {
  for (const auto& [id, row] : checkpoint.rows) {
    if (disk_.stored(id) != nullptr && !disk_.update(id, row)) return;
  }
  disk_.checkpoint_is_complete();
}

}  // namespace tessera::simulation
