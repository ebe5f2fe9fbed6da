// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/checkpointer.hpp"

#include <spdlog/spdlog.h>

#include <new>
#include <utility>

#include "server/farm/state_lock.hpp"
#include "server/film/tile_row.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::JobRecord;
using farm::StateLock;

core::Status Checkpointer::checkpoint() try {
  const std::lock_guard one_at_a_time(mutex_);
  held_back_.clear();
  unreadable_ = {};
  const std::vector<farm::JobSnapshot> changed = changed_jobs();
  const core::Status written = write(changed);
  film_memory_.free_stored();
  if (written) note_stored(changed);
  // Also after a failure, e.g. on a full disk: users can fetch the image from memory.
  publish_completions(changed);
  return written ? unreadable_ : written;
} catch (const std::bad_alloc&) {
  return core::fail(ErrorCode::kResourceExhausted, "out of memory");  // so short that it needs none
}

core::Status Checkpointer::write(const std::vector<farm::JobSnapshot>& changed) {
  if (auto there = store_.expect_file(); !there) return there;
  if (auto written = write_tiles(); !written) return written;
  for (const farm::JobSnapshot& job : changed) {
    if (held_back_.contains(job.spec->id())) continue;
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

std::vector<FilmOfJob> Checkpointer::films() {
  const StateLock lock(farm_);
  std::vector<FilmOfJob> films;
  for (const auto& [id, record] : lock->jobs)
    if (record.film) films.push_back({record.spec, record.film});
  return films;
}

// Batches span films: each costs a write to the disk.
core::Status Checkpointer::write_tiles() {
  TileBatch batch;
  for (const FilmOfJob& film : films()) {
    film.film->apply();
    for (ChangedTiles tiles(*film.film); tiles.first(); tiles.pop()) {
      take(film, *tiles.first(), batch);
      if (!batch.is_full()) continue;
      if (auto written = write(batch); !written) return written;
    }
  }
  return write(batch);
}

core::Status Checkpointer::write(TileBatch& batch) {
  if (batch.is_empty()) return {};
  if (auto written = store_.write_tiles(batch.rows()); !written) return written;
  batch.note_stored();
  return {};
}

void Checkpointer::take(const FilmOfJob& film, int tile, TileBatch& batch) {
  TakenTile* const taken = batch.take(film, tile);
  if (taken == nullptr) return;
  auto row = encode(film, *taken);
  if (row) return batch.add_row(std::move(*row));
  batch.give_back_last();
  note_unreadable(film, tile, row.error());
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

void Checkpointer::note_unreadable(const FilmOfJob& film, int tile, const core::Error& error) {
  const std::string& id = film.spec->id();
  if (StateLock(farm_)->find_job(id) == nullptr) return;  // deleted meanwhile, and its tiles with it
  held_back_.insert(id);
  if (error.code == ErrorCode::kDataLoss) return replace_lost(film, tile, error);
  if (unreadable_) unreadable_ = core::fail(error);
}

void Checkpointer::replace_lost(const FilmOfJob& film, int tile, const core::Error& error) {
  film::Notes spare(1);
  const auto drop = [&]() noexcept {  // the scheduler and the film must agree
    StateLock lock(farm_);
    const bool dropped = !lock.handle(scheduler::DropTile{{film.spec->id()}, tile}).dropped_tiles.empty();
    if (dropped) film.film->note_clear(tile, spare);
    return dropped;
  };
  if (drop()) return spdlog::error("{}: it is rendered again", error.message);
  film.film->forget_stored(tile);
  spdlog::error("{}: its job is not rendered any more, and its image lacks these samples", error.message);
}

void Checkpointer::note_stored(const std::vector<farm::JobSnapshot>& stored) {
  for (const auto& [id, film] : note_revisions(stored)) {
    if (!film->is_stored()) continue;
    const core::RenderCounters counters = film->counters();
    std::shared_ptr<film::JobFilm> dropped;  // destroyed without the lock
    StateLock lock(farm_);
    JobRecord* record = lock->find_job(id);
    const bool is_same = record != nullptr && !record->is_open && record->film == film &&
                         record->revision == record->stored_revision && film->is_stored();
    if (!is_same) continue;
    record->stored_counters = counters;
    dropped = std::move(record->film);
  }
}

std::map<std::string, std::shared_ptr<film::JobFilm>> Checkpointer::note_revisions(
    const std::vector<farm::JobSnapshot>& stored) {
  std::map<std::string, std::shared_ptr<film::JobFilm>> finished;
  StateLock lock(farm_);
  for (const farm::JobSnapshot& job : stored) {
    JobRecord* record = held_back_.contains(job.spec->id()) ? nullptr : lock->find_job(job.spec->id());
    if (record != nullptr) record->stored_revision = job.revision;
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
