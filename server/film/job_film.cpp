// SPDX-License-Identifier: Apache-2.0
#include "server/film/job_film.hpp"

#include <algorithm>
#include <atomic>
#include <new>
#include <utility>

namespace tessera::film {

namespace {

// Whether nobody has the part besides `owners` of the caller. Others take a part only under the film's mutex,
// and may let it go at any time.
bool is_sole_owner(const std::shared_ptr<TilePart>& part, long owners) {
  if (part.use_count() > owners) return false;
  std::atomic_thread_fence(std::memory_order_acquire);  // after the last reader
  return true;
}

}  // namespace

JobFilm::JobFilm(scheduler::JobGrid grid, FilmMemory& memory, events::RevisionCounter& revisions,
                 core::LayerSet layers)
    : grid_(grid),
      layers_(layers),
      layout_(std::make_shared<const core::FilmLayout>(core::film_layout(layers))),
      memory_(memory),
      revisions_(revisions),
      tiles_(static_cast<std::size_t>(grid.tile_count())),
      logs_(static_cast<std::size_t>(grid.image_count())),
      samples_by_image_(logs_.size()) {
  changed_.reserve(tiles_.size());
  memory_.take_tiles(tiles_.size());
}

JobFilm::~JobFilm() {
  memory_.give_back_tiles(tiles_.size());
}

std::shared_ptr<JobFilm> JobFilm::make(scheduler::JobGrid grid, FilmMemory& memory,
                                       events::RevisionCounter& revisions, core::LayerSet layers) {
  std::shared_ptr<JobFilm> film(new JobFilm(grid, memory, revisions, layers));
  memory.add(film);
  return film;
}

void JobFilm::restore(int tile, scheduler::IntervalSet stored, const core::RenderCounters& counters,
                      events::Revision revision) {
  const core::MutexLock lock(mutex_);
  at(tile).stored = std::move(stored);
  at(tile).revision = revision;
  log_of(tile).emplace(revision, tile);
  at(tile).stored_counters = counters;
  count(tile, counters);
}

void JobFilm::note_addition(Notes& additions, Notes::iterator addition) noexcept {
  const core::MutexLock lock(notes_mutex_);
  notes_.splice(notes_.end(), additions, addition);
}

void JobFilm::note_clear(int tile, Notes& spare) noexcept {
  spare.front().tile = tile;
  spare.front().kind = Note::Kind::kClear;
  const core::MutexLock lock(notes_mutex_);
  notes_.splice(notes_.end(), spare, spare.begin());
}

void JobFilm::note_review(int tile, Notes& spare) noexcept {
  spare.front().tile = tile;
  spare.front().kind = Note::Kind::kReview;
  const core::MutexLock lock(notes_mutex_);
  notes_.splice(notes_.end(), spare, spare.begin());
}

void JobFilm::apply() {
  const core::MutexLock lock(mutex_);
  Notes notes;
  {
    const core::MutexLock notes_lock(notes_mutex_);
    notes.swap(notes_);
  }
  try {
    for (; !notes.empty(); notes.pop_front()) follow(notes.front());
  } catch (...) {
    const core::MutexLock notes_lock(notes_mutex_);
    notes_.splice(notes_.begin(), notes);
    throw;
  }
}

void JobFilm::follow(const Note& note) {
  if (note.kind == Note::Kind::kAddition) return add(note);
  if (note.kind == Note::Kind::kClear) return clear(note.tile);
  note_change(note.tile);
}

void JobFilm::add(const Note& addition) {
  std::shared_ptr<TilePart>& newest = at(addition.tile).newest;
  append_event(addition.tile);  // first, since it may fail
  // Readers of a snapshot may hold the part: it is copied then.
  std::shared_ptr<TilePart> part = newest;
  if (!part)
    part = std::make_shared<TilePart>(layout_, grid_.rect(addition.tile), memory_);
  else if (!is_sole_owner(newest, 2))
    part = std::make_shared<TilePart>(*part);
  part->add(addition.samples);
  newest = std::move(part);
  count(addition.tile, addition.samples.counters);
  note_change(addition.tile);
}

void JobFilm::clear(int tile) {
  append_event(tile);
  Tile& cleared = at(tile);
  cleared.newest.reset();
  cleared.storing.reset();
  cleared.stored = {};
  cleared.stored_counters = {};
  ++cleared.generation;
  sum_counters();
  note_change(tile);
}

void JobFilm::count(int tile, const core::RenderCounters& counters) {
  total_.add(counters);
  samples_by_image_[static_cast<std::size_t>(grid_.image_of(tile))] += counters.samples;
}

void JobFilm::sum_counters() {
  total_ = {};
  std::fill(samples_by_image_.begin(), samples_by_image_.end(), 0);
  for (int tile = 0; tile < grid_.tile_count(); ++tile) {
    count(tile, at(tile).stored_counters);
    for (const TilePart* part : {at(tile).storing.get(), at(tile).newest.get()})
      if (part != nullptr) count(tile, part->counters());
  }
}

void JobFilm::note_change(int tile) noexcept {
  if (std::exchange(at(tile).is_changed, true)) return;
  changed_.push_back(tile);
}

void JobFilm::append_event(int tile) {
  events::Revision& last = at(tile).revision;
  auto& log = log_of(tile);
  const events::Revision revision = revisions_.next();
  if (last == 0) {
    log.emplace_hint(log.end(), revision, tile);
  } else {
    auto moved = log.extract(last);
    moved.key() = revision;
    log.insert(log.end(), std::move(moved));
  }
  last = revision;
}

TileSnapshot JobFilm::snapshot(int tile) const {
  const core::MutexLock lock(mutex_);
  return {at(tile).revision, at(tile).stored, at(tile).storing, at(tile).newest};
}

std::vector<TileEvent> JobFilm::changes_since(events::Revision since, std::size_t most, int image) const {
  std::vector<TileEvent> changes;
  changes.reserve(most);
  const core::MutexLock lock(mutex_);
  const auto& log = logs_[static_cast<std::size_t>(image)];
  for (auto next = log.upper_bound(since); next != log.end() && changes.size() < most; ++next)
    changes.push_back({next->first, next->second});
  return changes;
}

core::RenderCounters JobFilm::counters() const {
  const core::MutexLock lock(mutex_);
  return total_;
}

std::vector<std::uint64_t> JobFilm::samples_by_image() const {
  const core::MutexLock lock(mutex_);
  return samples_by_image_;
}

void JobFilm::note_producers(const std::vector<scheduler::ProducedItem>& items) {
  const core::MutexLock lock(mutex_);
  for (const scheduler::ProducedItem& each : items) producers_.add(each.producer);
}

ProducerKeys JobFilm::producers() const {
  const core::MutexLock lock(mutex_);
  return producers_;
}

bool JobFilm::is_stored() const {
  const core::MutexLock lock(mutex_);
  const core::MutexLock notes_lock(notes_mutex_);
  return changed_.empty() && notes_.empty();
}

std::vector<int> JobFilm::take_changed_tiles() {
  std::vector<int> taken;
  taken.reserve(static_cast<std::size_t>(grid_.tile_count()));
  const core::MutexLock lock(mutex_);
  taken.swap(changed_);
  return taken;
}

void JobFilm::put_back_changed_tiles(std::span<const int> tiles) noexcept {
  const core::MutexLock lock(mutex_);
  changed_.insert(changed_.end(), tiles.begin(), tiles.end());
}

std::optional<TileToStore> JobFilm::begin_store(int tile) {
  const core::MutexLock lock(mutex_);
  Tile& taken = at(tile);
  if (!taken.is_changed) return std::nullopt;
  // A part that could not be stored is stored with the newer samples.
  std::shared_ptr<TilePart> storing = taken.storing ? taken.storing : taken.newest;
  if (taken.storing && taken.newest) storing = merge(taken.storing, *taken.newest);
  TileToStore result{{taken.revision, taken.stored, storing, nullptr},
                     taken.stored,
                     taken.stored_counters,
                     taken.generation};
  if (storing) {
    result.samples.add(storing->samples());
    result.counters.add(storing->counters());
  }
  // Nothing fails from here on.
  taken.storing = std::move(storing);
  taken.newest.reset();
  taken.is_changed = false;
  return result;
}

void JobFilm::forget_stored(int tile) {
  const core::MutexLock lock(mutex_);
  at(tile).stored = {};
  at(tile).stored_counters = {};
  sum_counters();
  note_change(tile);
}

void JobFilm::stored(int tile, TileToStore done, std::shared_ptr<TilePart> whole) {
  const core::MutexLock lock(mutex_);
  Tile& stored = at(tile);
  if (stored.generation != done.generation) return;
  std::shared_ptr<TilePart> storing = std::exchange(stored.storing, nullptr);
  if (!whole && done.parts.stored.empty()) whole = std::move(storing);
  done.parts.storing.reset();
  if (!memory_.may_keep_stored()) whole.reset();
  if (whole && stored.newest) whole = merge_or_null(std::move(whole), *stored.newest);
  stored.stored = whole ? scheduler::IntervalSet() : std::move(done.samples);
  stored.stored_counters = whole ? core::RenderCounters() : done.counters;
  if (whole) stored.newest = std::move(whole);
}

std::shared_ptr<TilePart> JobFilm::merge(std::shared_ptr<TilePart> part, const TilePart& newer) {
  if (!is_sole_owner(part, 1)) part = std::make_shared<TilePart>(*part);
  part->add(newer);
  return part;
}

std::shared_ptr<TilePart> JobFilm::merge_or_null(std::shared_ptr<TilePart> part, const TilePart& newer) try {
  return merge(std::move(part), newer);
} catch (const std::bad_alloc&) {
  return nullptr;
}

void JobFilm::not_stored(int tile, const TileToStore& failed) noexcept {
  const core::MutexLock lock(mutex_);
  if (at(tile).generation == failed.generation) note_change(tile);
}

bool JobFilm::free_stored() {
  const core::MutexLock lock(mutex_);
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
