// SPDX-License-Identifier: Apache-2.0
#include "server/film/job_film.hpp"

#include <atomic>
#include <new>
#include <utility>

namespace tessera::film {

JobFilm::JobFilm(core::TileGrid grid, FilmMemory& memory)
    : grid_(grid), memory_(memory), tiles_(static_cast<std::size_t>(grid.tile_count())) {
  changed_.reserve(tiles_.size());
  memory_.take_tiles(tiles_.size());
}

JobFilm::~JobFilm() {
  memory_.give_back_tiles(tiles_.size());
}

std::shared_ptr<JobFilm> JobFilm::make(core::TileGrid grid, FilmMemory& memory) {
  std::shared_ptr<JobFilm> film(new JobFilm(grid, memory));
  memory.add(film);
  return film;
}

void JobFilm::restore(int tile, scheduler::IntervalSet stored, const core::RenderCounters& counters) {
  at(tile).stored = std::move(stored);
  at(tile).stored_counters = counters;
  total_.add(counters);
}

void JobFilm::note_addition(Additions& additions, Additions::iterator addition) noexcept {
  const std::lock_guard lock(notes_mutex_);
  notes_.splice(notes_.end(), additions, addition);
}

void JobFilm::note_clear(int tile, Additions& spare) noexcept {
  spare.front().tile = tile;
  spare.front().samples.rect = {};
  const std::lock_guard lock(notes_mutex_);
  notes_.splice(notes_.end(), spare, spare.begin());
}

void JobFilm::apply() {
  const std::lock_guard lock(mutex_);
  Additions notes;
  {
    const std::lock_guard notes_lock(notes_mutex_);
    notes.swap(notes_);
  }
  try {
    for (; !notes.empty(); notes.pop_front())
      notes.front().samples.rect.empty() ? clear(notes.front().tile) : add(notes.front());
  } catch (...) {
    const std::lock_guard notes_lock(notes_mutex_);
    notes_.splice(notes_.begin(), notes);
    throw;
  }
}

void JobFilm::add(const Addition& addition) {
  own_newest(addition.tile).add(addition.samples);
  total_.add(addition.samples.counters);
  note_change(addition.tile);
}

// Readers of a snapshot may hold the part: it is copied then.
TilePart& JobFilm::own_newest(int tile) {
  std::shared_ptr<TilePart>& newest = at(tile).newest;
  if (!newest) {
    newest = std::make_shared<TilePart>(grid_.rect(tile).pixel_count() * 3, memory_);
  } else if (newest.use_count() > 1) {
    newest = std::make_shared<TilePart>(*newest);
  } else {
    std::atomic_thread_fence(std::memory_order_acquire);  // the last reader has let it go
  }
  return *newest;
}

void JobFilm::clear(int tile) {
  Tile& cleared = at(tile);
  cleared.newest.reset();
  cleared.storing.reset();
  cleared.stored = {};
  cleared.stored_counters = {};
  ++cleared.generation;
  total_ = {};
  for (const Tile& each : tiles_) {
    total_.add(each.stored_counters);
    for (const auto& part : {each.storing, each.newest})
      if (part) total_.add(part->counters());
  }
  note_change(tile);
}

void JobFilm::note_change(int tile) noexcept {
  if (std::exchange(at(tile).is_changed, true)) return;
  changed_.push_back(tile);
}

TileSnapshot JobFilm::snapshot(int tile) const {
  const std::lock_guard lock(mutex_);
  return {at(tile).stored, at(tile).storing, at(tile).newest};
}

core::RenderCounters JobFilm::counters() const {
  const std::lock_guard lock(mutex_);
  return total_;
}

bool JobFilm::is_stored() const {
  const std::lock_guard lock(mutex_);
  const std::lock_guard notes_lock(notes_mutex_);
  return changed_.empty() && notes_.empty();
}

void JobFilm::mark_changed(int tile) {
  const std::lock_guard lock(mutex_);
  note_change(tile);
}

std::vector<int> JobFilm::take_changed_tiles() {
  std::vector<int> taken;
  taken.reserve(tiles_.size());
  const std::lock_guard lock(mutex_);
  taken.swap(changed_);
  return taken;
}

void JobFilm::put_back_changed_tiles(std::span<const int> tiles) noexcept {
  const std::lock_guard lock(mutex_);
  changed_.insert(changed_.end(), tiles.begin(), tiles.end());
}

std::optional<TileToStore> JobFilm::begin_store(int tile) {
  const std::lock_guard lock(mutex_);
  Tile& stored = at(tile);
  if (!stored.is_changed) return std::nullopt;
  // A part that could not be stored is stored with the newer samples.
  if (stored.storing && stored.newest) stored.newest = together(stored.storing, *stored.newest);
  if (stored.newest) stored.storing = std::exchange(stored.newest, nullptr);
  stored.is_changed = false;
  TileToStore result{
      {stored.stored, stored.storing, nullptr}, stored.stored, stored.stored_counters, stored.generation};
  if (stored.storing) {
    result.samples.add(stored.storing->samples());
    result.counters.add(stored.storing->counters());
  }
  return result;
}

void JobFilm::stored(int tile, TileToStore done, std::shared_ptr<TilePart> whole) {
  const std::lock_guard lock(mutex_);
  Tile& stored = at(tile);
  if (stored.generation != done.generation) return;
  std::shared_ptr<TilePart> storing = std::exchange(stored.storing, nullptr);
  if (!whole && done.parts.stored.empty()) whole = std::move(storing);
  done.parts.storing.reset();
  if (!memory_.may_keep_stored()) whole.reset();
  if (whole && stored.newest) whole = together_or_null(std::move(whole), *stored.newest);
  stored.stored = whole ? scheduler::IntervalSet() : std::move(done.samples);
  stored.stored_counters = whole ? core::RenderCounters() : done.counters;
  if (whole) stored.newest = std::move(whole);
}

std::shared_ptr<TilePart> JobFilm::together(std::shared_ptr<TilePart> part, const TilePart& newer) {
  auto both = part.use_count() > 1 ? std::make_shared<TilePart>(*part) : std::move(part);
  both->add(newer);
  return both;
}

std::shared_ptr<TilePart> JobFilm::together_or_null(std::shared_ptr<TilePart> part,
                                                    const TilePart& newer) try {
  return together(std::move(part), newer);
} catch (const std::bad_alloc&) {
  return nullptr;
}

void JobFilm::not_stored(int tile, const TileToStore& failed) noexcept {
  const std::lock_guard lock(mutex_);
  if (at(tile).generation == failed.generation) note_change(tile);
}

bool JobFilm::free_stored() {
  const std::lock_guard lock(mutex_);
  bool freed_any = false;
  for (std::size_t i = 0; i < tiles_.size() && !memory_.may_keep_stored(); ++i) {
    Tile& freed = at(next_to_free_);
    next_to_free_ = (next_to_free_ + 1) % grid_.tile_count();
    const bool is_stored = freed.newest && freed.stored.empty() && !freed.storing && !freed.is_changed;
    if (!is_stored) continue;
    freed.stored = freed.newest->samples();
    freed.stored_counters = freed.newest->counters();
    freed.newest.reset();
    freed_any = true;
  }
  return freed_any;
}

}  // namespace tessera::film
