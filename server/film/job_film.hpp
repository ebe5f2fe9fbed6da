// SPDX-License-Identifier: Apache-2.0
// The film of one job in progress.
//
// The samples of a tile are in up to three places, and add up in any order: the store; a part that is being
// stored at this moment; and a part in memory, which has the newest samples. A tile whose part was freed
// needs no memory, and takes new samples without being read back.
//
// The scheduler's decisions are noted under the state lock, which takes no time, and done after it: notes are
// done in their order, by whoever calls apply() next. Thread-safe.
#pragma once

#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/film/film.hpp"
#include "server/events/revision.hpp"
#include "server/film/film_memory.hpp"
#include "server/film/producer_keys.hpp"
#include "server/film/tile_part.hpp"
#include "server/scheduler/events.hpp"
#include "server/scheduler/interval_set.hpp"

namespace tessera::film {

// What happens to a tile.
struct Note {
  enum class Kind {
    kAddition,  // new samples
    kClear,     // all samples were wrong
    kReview,    // its provenance has changed: it must be stored again
  };
  int tile = 0;
  core::FilmTile samples{};  // of kAddition
  Kind kind = Kind::kAddition;
};
// A list, so that noting allocates no memory.
using Notes = std::list<Note>;

// A change of a tile's samples.
struct TileEvent {
  events::Revision revision = 0;
  int tile = 0;
};

// The parts of a tile at one moment.
struct TileSnapshot {
  events::Revision revision = 0;            // of the last change of its samples
  scheduler::IntervalSet stored;            // the samples that only the store has
  std::shared_ptr<const TilePart> storing;  // null if there are none
  std::shared_ptr<const TilePart> newest;   // null if there are none
};

// A tile to store.
struct TileToStore {
  TileSnapshot parts;  // `newest` is null
  scheduler::IntervalSet samples;
  core::RenderCounters counters;
  std::uint32_t generation = 0;
};

class JobFilm {
 public:
  // `memory` must outlive the film and all snapshots of it, and `revisions` the film.
  static std::shared_ptr<JobFilm> make(core::TileGrid grid, FilmMemory& memory,
                                       events::RevisionCounter& revisions);
  ~JobFilm();
  // The store has these samples since this revision. Only before the film is shared.
  void restore(int tile, scheduler::IntervalSet stored, const core::RenderCounters& counters,
               events::Revision revision);

  const core::TileGrid& grid() const { return grid_; }

  // ---- Under the state lock. These take no time and cannot fail ----
  // Takes the element out of `additions`. The caller adds no sample twice.
  void note_addition(Notes& additions, Notes::iterator addition) noexcept;
  // These take an element out of `spare`, which must not be empty.
  void note_clear(int tile, Notes& spare) noexcept;
  void note_review(int tile, Notes& spare) noexcept;

  // ---- Without the state lock ----
  // Does what was noted before this call. Throws std::bad_alloc if there is no memory; nothing is lost then,
  // and a later call does the rest.
  void apply();

  TileSnapshot snapshot(int tile) const;
  // The last changes of at most `most` tiles that changed after `since`, in their order.
  std::vector<TileEvent> changes_since(events::Revision since, std::size_t most) const;
  // The counters of all samples together.
  core::RenderCounters counters() const;
  bool is_stored() const;
  // Those who may have rendered samples that nobody has verified, of all tiles that were ever stored.
  void note_producers(const std::vector<scheduler::ProducedItem>& items);
  ProducerKeys producers() const;

  // ---- For the only thread that stores tiles ----
  // The tiles that must be stored. Those that are not stored must be put back.
  std::vector<int> take_changed_tiles();
  void put_back_changed_tiles(std::span<const int> tiles) noexcept;
  // Empty if the tile is stored already. Every begin_store() is followed by stored() or not_stored().
  std::optional<TileToStore> begin_store(int tile);
  // The store has the tile. `whole` has all of its samples, unless the part that was stored has; they stay in
  // memory if there is room.
  void stored(int tile, TileToStore done, std::shared_ptr<TilePart> whole);
  void not_stored(int tile, const TileToStore& failed) noexcept;
  // The store has lost its part of the tile.
  void forget_stored(int tile);

  // ---- For FilmMemory ----
  // Frees parts of tiles that the store has, while there is no room for them. Returns whether it freed any.
  bool free_stored();

 private:
  struct Tile {
    std::shared_ptr<TilePart> newest, storing;
    scheduler::IntervalSet stored;
    core::RenderCounters stored_counters;
    events::Revision revision = 0;
    std::uint32_t generation = 0;  // incremented when the tile is cleared
    bool is_changed = false;       // whether it must be stored
  };

  JobFilm(core::TileGrid grid, FilmMemory& memory, events::RevisionCounter& revisions);
  Tile& at(int tile) { return tiles_[static_cast<std::size_t>(tile)]; }
  const Tile& at(int tile) const { return tiles_[static_cast<std::size_t>(tile)]; }
  void follow(const Note& note);
  void add(const Note& addition);
  void clear(int tile);
  void sum_counters();
  // The tile must be stored.
  void note_change(int tile) noexcept;
  // The samples of the tile have changed.
  void append_event(int tile);
  // Both parts as one: the first one itself, unless somebody else has it.
  static std::shared_ptr<TilePart> merge(std::shared_ptr<TilePart> part, const TilePart& newer);
  // The same; null if there is no memory.
  static std::shared_ptr<TilePart> merge_or_null(std::shared_ptr<TilePart> part, const TilePart& newer);

  const core::TileGrid grid_;
  FilmMemory& memory_;
  events::RevisionCounter& revisions_;

  mutable std::mutex notes_mutex_;
  Notes notes_;  // guarded by notes_mutex_

  mutable std::mutex mutex_;
  // Guarded by mutex_:
  std::vector<Tile> tiles_;
  std::vector<int> changed_;             // those that were not taken; has room for all tiles
  std::map<events::Revision, int> log_;  // the tiles in the order of their last changes
  core::RenderCounters total_;
  ProducerKeys producers_;
  int next_to_free_ = 0;
};

}  // namespace tessera::film
