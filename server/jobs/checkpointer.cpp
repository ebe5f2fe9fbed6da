// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/checkpointer.hpp"

#include <algorithm>
#include <utility>

#include "server/farm/state_lock.hpp"
#include "server/film/stored_tile.hpp"

namespace tessera::jobs {

using farm::JobRecord;
using farm::StateLock;

core::Status Checkpointer::checkpoint() {
  const std::lock_guard one_at_a_time(mutex_);
  const std::vector<farm::JobSnapshot> changed = changed_jobs();
  const core::Status written = write(changed);
  if (written) note_stored(changed);
  // Also after a failure, e.g. on a full disk: users can fetch the image from memory.
  publish_completions(changed);
  return written;
}

core::Status Checkpointer::write(const std::vector<farm::JobSnapshot>& changed) {
  if (auto there = store_.expect_file(); !there) return there;
  const std::vector<TileRef> tiles = changed_tiles();
  for (std::size_t begin = 0; begin < tiles.size(); begin += film::kTilesPerBatch) {
    const std::size_t count = std::min(film::kTilesPerBatch, tiles.size() - begin);
    if (auto written = write_tiles(std::span(tiles).subspan(begin, count)); !written) return written;
  }
  for (const farm::JobSnapshot& job : changed) {
    if (auto written = store_.update_job(to_row(job)); !written) return written;
  }
  return {};
}

std::vector<farm::JobSnapshot> Checkpointer::changed_jobs() {
  StateLock lock(farm_);
  lock->checkpoint_is_awaited = false;
  std::vector<farm::JobSnapshot> changed;
  for (const auto& [id, record] : lock->jobs) {
    if (record.revision != record.stored_revision)
      changed.emplace_back(record, *lock->scheduler.job({id}, lock.now()));
  }
  return changed;
}

std::vector<Checkpointer::TileRef> Checkpointer::changed_tiles() {
  const StateLock lock(farm_);
  std::vector<TileRef> tiles;
  for (const auto& [id, record] : lock->jobs) {
    if (!record.film) continue;
    for (const int tile : record.film->changed()) tiles.push_back({id, tile});
  }
  return tiles;
}

std::optional<Checkpointer::TileCopy> Checkpointer::copy(const TileRef& ref) {
  const StateLock lock(farm_);
  const JobRecord* record = lock->find_job(ref.job_id);
  if (record == nullptr || !record->film) return std::nullopt;  // deleted meanwhile
  record->film->mark_clean(ref.tile);
  TileCopy copy{farm::grid_of(*record->spec).rect(ref.tile),
                lock->scheduler.done({ref.job_id}, ref.tile).ranges(), record->film->copy(ref.tile)};
  copy.content.provenance = {fingerprinter_.check(), lock->scheduler.provenance({ref.job_id}, ref.tile)};
  return copy;
}

core::Status Checkpointer::write_tiles(std::span<const TileRef> tiles) {
  std::vector<store::TileRow> rows;
  for (const TileRef& ref : tiles) {  // one at a time: its sums stay in the CPU cache until they are encoded
    auto tile = copy(ref);
    if (!tile) continue;
    rows.push_back(
        film::encode_tile_row(ref.job_id, ref.tile, tile->rect, std::move(tile->done), tile->content));
  }
  auto written = store_.write_tiles(rows);
  if (written) return written;
  StateLock lock(farm_);
  for (const TileRef& ref : tiles) {
    JobRecord* record = lock->find_job(ref.job_id);
    if (record != nullptr && record->film) record->film->mark_changed(ref.tile);
  }
  return written;
}

void Checkpointer::note_stored(const std::vector<farm::JobSnapshot>& stored) {
  std::vector<std::unique_ptr<film::JobFilm>> dropped;  // destroyed without the lock
  StateLock lock(farm_);
  for (const farm::JobSnapshot& job : stored) {
    if (JobRecord* record = lock->find_job(job.spec->id())) record->stored_revision = job.revision;
  }
  for (auto& [id, record] : lock->jobs) {
    const bool is_stored = record.film && !record.is_open && record.film->changed().empty() &&
                           record.revision == record.stored_revision;
    if (!is_stored) continue;
    record.stored_counters = record.film->counters();
    dropped.push_back(std::move(record.film));
  }
}

void Checkpointer::publish_completions(const std::vector<farm::JobSnapshot>& stored) {
  StateLock lock(farm_);
  for (const farm::JobSnapshot& job : stored) {
    JobRecord* record = lock->find_job(job.spec->id());
    if (record != nullptr && record->unpublished_completion &&
        *record->unpublished_completion <= job.revision)
      record->unpublished_completion.reset();
  }
}

}  // namespace tessera::jobs
