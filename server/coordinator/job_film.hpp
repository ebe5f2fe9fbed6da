// SPDX-License-Identifier: Apache-2.0
// The film of one job while it is rendered: sums and counters tile by tile, and which tiles the store lacks.
// Not thread-safe; the coordinator's gate guards it.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "server/coordinator/tile_provenance.hpp"
#include "server/store/job_store.hpp"

namespace tessera::coordinator {

// What a tile holds, by itself.
struct TileContent {
  core::Film::TileSums sums;
  core::RenderCounters counters;
  // Who rendered it, in the store alone: while a job runs, the scheduler knows.
  Produced provenance{};
};

class JobFilm {
 public:
  explicit JobFilm(core::TileGrid grid);

  // Takes the memory for samples of one tile. std::bad_alloc if there is none.
  void reserve(const core::FilmTile& samples) { film_.reserve(samples); }
  // Adds samples of one tile, for which memory was reserved before they counted as done. The caller sees to
  // it that none is added twice.
  void add(int tile, const core::FilmTile& samples) noexcept;
  // Takes all samples of a tile out again.
  void clear(int tile);
  // Puts back what the store had of a tile that is empty so far.
  void restore(int tile, const TileContent& content);

  TileContent copy(int tile) const;
  const core::Film& film() const { return film_; }
  // Of all tiles together.
  const core::RenderCounters& counters() const;

  // Tiles that changed since they were last marked clean.
  const std::set<int>& changed() const { return changed_; }
  void mark_clean(int tile) { changed_.erase(tile); }
  void mark_changed(int tile) { changed_.insert(tile); }

 private:
  core::Film film_;
  std::vector<core::RenderCounters> counters_;         // by tile
  mutable std::optional<core::RenderCounters> total_;  // absent: to be added up again
  std::set<int> changed_;
};

// A tile as the store keeps it, and back. `done` are the samples in it.
store::TileRow encode_tile_row(const std::string& job_id, int tile, const core::PixelRect& rect,
                               std::vector<core::SampleRange> done, const TileContent& content);
// DATA_LOSS if it is not what encode_tile_row made for this rectangle.
core::Result<TileContent> decode_tile_row(const store::TileRow& row, const core::PixelRect& rect);

}  // namespace tessera::coordinator
