// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/checkpointer.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>
#include <span>
#include <utility>

#include "server/farm/state_lock.hpp"
#include "server/film/stored_tile.hpp"

namespace tessera::jobs {

using farm::JobRecord;
using farm::StateLock;

core::Status Checkpointer::checkpoint() {
  const std::lock_guard one_at_a_time(mutex_);
  damaged_jobs_.clear();
  const std::vector<farm::JobSnapshot> changed = changed_jobs();
  const core::Status written = guarded_write(changed);
  film_memory_.free_stored();
  if (written) note_stored(changed);
  // Also after a failure, e.g. on a full disk: users can fetch the image from memory.
  publish_completions(changed);
  return written;
}

core::Status Checkpointer::guarded_write(const std::vector<farm::JobSnapshot>& changed) try {
  return write(changed);
} catch (const std::bad_alloc&) {
  return core::fail(core::ErrorCode::kResourceExhausted, "there is not enough memory to write a checkpoint");
}

core::Status Checkpointer::write(const std::vector<farm::JobSnapshot>& changed) {
  if (auto there = store_.expect_file(); !there) return there;
  for (const FilmOfJob& film : films()) {
    film.film->apply();
    if (auto written = write(film); !written) return written;
  }
  for (const farm::JobSnapshot& job : changed) {
    if (damaged_jobs_.contains(job.spec->id())) continue;  // it runs again, which the next checkpoint writes
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

std::vector<Checkpointer::FilmOfJob> Checkpointer::films() {
  const StateLock lock(farm_);
  std::vector<FilmOfJob> films;
  for (const auto& [id, record] : lock->jobs)
    if (record.film) films.push_back({record.spec, record.film});
  return films;
}

// The changed tiles of a film, while they are being stored. Gives back those that were not.
class Checkpointer::ChangedTiles {
 public:
  explicit ChangedTiles(film::JobFilm& film) : film_(film), all_(film.take_changed_tiles()), rest_(all_) {
    taken_.reserve(film::kTilesPerBatch);
  }
  ~ChangedTiles() {
    for (const TakenTile& each : taken_) film_.not_stored(each.tile, each.to_store);
    film_.put_back_changed_tiles(rest_);
  }
  ChangedTiles(const ChangedTiles&) = delete;
  ChangedTiles& operator=(const ChangedTiles&) = delete;

  bool all_taken() const { return rest_.empty(); }
  // Takes the next tile of a batch. Null if there is none left, or the batch is full.
  TakenTile* take_next() {
    while (!rest_.empty() && taken_.size() < film::kTilesPerBatch) {
      const int tile = rest_.front();
      auto to_store = film_.begin_store(tile);
      rest_ = rest_.subspan(1);
      if (to_store) return &taken_.emplace_back(TakenTile{tile, *std::move(to_store), nullptr});
    }
    return nullptr;
  }
  void give_back_last() {
    film_.not_stored(taken_.back().tile, taken_.back().to_store);
    taken_.pop_back();
  }
  void note_stored() {
    for (TakenTile& each : taken_) film_.stored(each.tile, std::move(each.to_store), std::move(each.whole));
    taken_.clear();
  }

 private:
  film::JobFilm& film_;
  const std::vector<int> all_;
  std::span<const int> rest_;
  std::vector<TakenTile> taken_;  // the batch
};

core::Status Checkpointer::write(const FilmOfJob& film) {
  ChangedTiles tiles(*film.film);
  while (!tiles.all_taken()) {
    if (auto written = write_batch(film, tiles); !written) return written;
  }
  return {};
}

core::Status Checkpointer::write_batch(const FilmOfJob& film, ChangedTiles& tiles) {
  std::vector<store::TileRow> rows;
  while (TakenTile* tile = tiles.take_next()) {  // one at a time: its sums stay in the CPU cache
    auto row = encode(film, *tile);
    if (row) {
      rows.push_back(std::move(*row));
      continue;
    }
    const int damaged = tile->tile;
    tiles.give_back_last();
    if (row.error().code != core::ErrorCode::kDataLoss) return core::fail(row.error());
    note_damage(film, damaged, row.error());
  }
  if (auto written = store_.write_tiles(rows); !written) return written;
  tiles.note_stored();
  return {};
}

core::Result<store::TileRow> Checkpointer::encode(const FilmOfJob& film, TakenTile& tile) {
  const film::TileSnapshot& parts = tile.to_store.parts;
  film::TileContent content{{}, tile.to_store.counters, {}};
  if (parts.stored.empty()) {
    if (parts.storing) content.sums = parts.storing->sums();
  } else {
    auto whole = films_.whole(*film.spec, tile.tile, tile.to_store);
    if (!whole) return core::fail(whole.error());
    tile.whole = std::move(*whole);
    content.sums = tile.whole->sums();
  }
  content.provenance = provenance_of(film, tile.tile);
  return film::encode_tile_row(film.spec->id(), tile.tile, film.film->grid().rect(tile.tile),
                               tile.to_store.samples.ranges(), content);
}

film::Produced Checkpointer::provenance_of(const FilmOfJob& film, int tile) {
  const StateLock lock(farm_);
  if (lock->find_job(film.spec->id()) == nullptr) return {};  // deleted meanwhile
  return {fingerprinter_.check(), lock->scheduler.provenance({film.spec->id()}, tile)};
}

void Checkpointer::note_damage(const FilmOfJob& film, int tile, const core::Error& error) {
  spdlog::error("{}: it is rendered again", error.message);
  damaged_jobs_.insert(film.spec->id());
  film::Additions spare(1);
  StateLock lock(farm_);
  const scheduler::Actions actions = lock.handle(scheduler::DropTile{{film.spec->id()}, tile});
  if (!actions.dropped_tiles.empty()) film.film->note_clear(tile, spare);
}

void Checkpointer::note_stored(const std::vector<farm::JobSnapshot>& stored) {
  for (const auto& [id, film] : note_revisions(stored)) {
    if (!film->is_stored()) continue;
    const core::RenderCounters counters = film->counters();
    std::shared_ptr<film::JobFilm> dropped;  // destroyed without the lock
    StateLock lock(farm_);
    JobRecord* record = lock->find_job(id);
    if (record == nullptr || record->is_open || record->film != film) continue;
    record->stored_counters = counters;
    dropped = std::move(record->film);
  }
}

std::map<std::string, std::shared_ptr<film::JobFilm>> Checkpointer::note_revisions(
    const std::vector<farm::JobSnapshot>& stored) {
  std::map<std::string, std::shared_ptr<film::JobFilm>> finished;
  StateLock lock(farm_);
  for (const farm::JobSnapshot& job : stored) {
    if (JobRecord* record = lock->find_job(job.spec->id())) record->stored_revision = job.revision;
  }
  for (const auto& [id, record] : lock->jobs) {
    if (record.film && !record.is_open && record.revision == record.stored_revision)
      finished.emplace(id, record.film);
  }
  return finished;
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
