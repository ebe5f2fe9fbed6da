// SPDX-License-Identifier: Apache-2.0
// The films of one job in progress: those of all its images, whose tiles are numbered in one sequence.
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
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/mutex.hpp"
#include "core/film/film.hpp"
#include "core/film/layout.hpp"
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
  // `memory` must outlive the film and all snapshots of it, and `revisions` the film. `layers`: of all
  // images.
  static std::shared_ptr<JobFilm> make(scheduler::JobGrid grid, FilmMemory& memory,
                                       events::RevisionCounter& revisions, core::LayerSet layers = {});
  ~JobFilm();
  // The store has these samples since this revision. Only before anything else is called.
  void restore(int tile, scheduler::IntervalSet stored, const core::RenderCounters& counters,
               events::Revision revision);

  const scheduler::JobGrid& grid() const { return grid_; }
  core::LayerSet layers() const { return layers_; }

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
  // The last changes of at most `most` tiles of an image that changed after `since`, in their order.
  std::vector<TileEvent> changes_since(events::Revision since, std::size_t most, int image = 0) const;
  // The counters of all samples together.
  core::RenderCounters counters() const;
  // The pixel samples in each image.
  std::vector<std::uint64_t> samples_by_image() const;
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

  JobFilm(scheduler::JobGrid grid, FilmMemory& memory, events::RevisionCounter& revisions,
          core::LayerSet layers);
  Tile& at(int tile) TESSERA_REQUIRES(mutex_) { return tiles_[static_cast<std::size_t>(tile)]; }
  const Tile& at(int tile) const TESSERA_REQUIRES(mutex_) { return tiles_[static_cast<std::size_t>(tile)]; }
  std::map<events::Revision, int>& log_of(int tile) TESSERA_REQUIRES(mutex_) {
    return logs_[static_cast<std::size_t>(grid_.image_of(tile))];
  }
  void follow(const Note& note) TESSERA_REQUIRES(mutex_);
  void add(const Note& addition) TESSERA_REQUIRES(mutex_);
  void clear(int tile) TESSERA_REQUIRES(mutex_);
  void count(int tile, const core::RenderCounters& counters) TESSERA_REQUIRES(mutex_);
  void sum_counters() TESSERA_REQUIRES(mutex_);
  // The tile must be stored.
  void note_change(int tile) noexcept TESSERA_REQUIRES(mutex_);
  // The samples of the tile have changed.
  void append_event(int tile) TESSERA_REQUIRES(mutex_);
  // Both parts as one: the first one itself, unless somebody else has it.
  static std::shared_ptr<TilePart> merge(std::shared_ptr<TilePart> part, const TilePart& newer);
  // The same; null if there is no memory.
  static std::shared_ptr<TilePart> merge_or_null(std::shared_ptr<TilePart> part, const TilePart& newer);

  const scheduler::JobGrid grid_;
  const core::LayerSet layers_;
  const std::shared_ptr<const core::FilmLayout> layout_;
  FilmMemory& memory_;
  events::RevisionCounter& revisions_;

  mutable core::Mutex notes_mutex_;
  Notes notes_ TESSERA_GUARDED_BY(notes_mutex_);

  mutable core::Mutex mutex_;
  std::vector<Tile> tiles_ TESSERA_GUARDED_BY(mutex_);
  std::vector<int> changed_ TESSERA_GUARDED_BY(mutex_);  // those that were not taken; has room for all tiles
  // By image: its tiles in the order of their last changes.
  std::vector<std::map<events::Revision, int>> logs_ TESSERA_GUARDED_BY(mutex_);
  core::RenderCounters total_ TESSERA_GUARDED_BY(mutex_);
  std::vector<std::uint64_t> samples_by_image_ TESSERA_GUARDED_BY(mutex_);
  ProducerKeys producers_ TESSERA_GUARDED_BY(mutex_);
  int next_to_free_ TESSERA_GUARDED_BY(mutex_) = 0;
};

}  // namespace tessera::film
