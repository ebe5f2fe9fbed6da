// SPDX-License-Identifier: Apache-2.0
// The film of one job in progress: sums and counters by tile, and which tiles the store lacks. Not
// thread-safe; guarded by the coordinator's state mutex.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "server/film/tile_provenance.hpp"
#include "server/store/job_store.hpp"

namespace tessera::film {

// The content of one tile.
struct TileContent {
  core::Film::TileSums sums;
  core::RenderCounters counters;
  // The producers of the samples; filled in only when read from the store. While a job runs, the scheduler
  // has them.
  Produced provenance{};
};

class JobFilm {
 public:
  explicit JobFilm(core::TileGrid grid);

  // Allocates memory for samples of one tile. Throws std::bad_alloc if there is none.
  void reserve(const core::FilmTile& samples) { film_.reserve(samples); }
  // Adds samples of one tile. Memory for them must have been reserved before they counted as done, and the
  // caller must add none twice.
  void add(int tile, const core::FilmTile& samples) noexcept;
  // Removes all samples of a tile.
  void clear(int tile);
  // Restores a tile, which must be empty, from the store.
  void restore(int tile, const TileContent& content);

  TileContent copy(int tile) const;
  const core::Film& film() const { return film_; }
  // The counters of all tiles together.
  const core::RenderCounters& counters() const;

  // Tiles that changed since they were last marked clean.
  const std::set<int>& changed() const { return changed_; }
  void mark_clean(int tile) { changed_.erase(tile); }
  void mark_changed(int tile) { changed_.insert(tile); }

 private:
  core::Film film_;
  std::vector<core::RenderCounters> counters_;         // by tile
  mutable std::optional<core::RenderCounters> total_;  // empty if it must be computed again
  std::set<int> changed_;
};

// Converts a tile to a row of the store. `done` are the samples in it.
store::TileRow encode_tile_row(const std::string& job_id, int tile, const core::PixelRect& rect,
                               std::vector<core::SampleRange> done, const TileContent& content);
// Converts it back. DATA_LOSS if the row is not one that encode_tile_row made for this rectangle.
core::Result<TileContent> decode_tile_row(const store::TileRow& row, const core::PixelRect& rect);

}  // namespace tessera::film
