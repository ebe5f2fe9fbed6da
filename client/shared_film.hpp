// SPDX-License-Identifier: Apache-2.0
// The film of a local render, which one thread adds to while others read it. Thread-safe, except film().
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "client/render_observer.hpp"
#include "core/film/film.hpp"

namespace tessera::client {

// What a render has done so far, with the runs that it continues.
struct RenderTotals {
  core::RenderCounters counters;
  double seconds = 0;       // by the clock on the wall
  double core_seconds = 0;  // of all cores together

  void add(const RenderTotals& other);
};

class SharedFilm {
 public:
  explicit SharedFilm(core::TileGrid grid, core::LayerSet layers = {}) : film_(grid, layers) {}
  // Continues with this film.
  SharedFilm(core::Film film, const RenderTotals& totals) : film_(std::move(film)), totals_(totals) {}

  // For the thread that adds samples, and for others under the mutex of an observer.
  const core::Film& film() const { return film_; }
  const core::TileGrid& grid() const { return film_.grid(); }
  RenderTotals totals() const;

  // Adds the tile and what it took. Blocks while an observer reads.
  void add(const core::FilmTile& tile, const RenderTotals& work,
           const std::vector<RenderObserver*>& observers);

  // The samples of each pixel of each grid tile.
  std::vector<std::uint32_t> samples() const;
  // Of one grid tile.
  core::Film::TileSums tile(int index) const;
  // The image of what there is, each tile of a moment of its own.
  core::Image develop() const;

  // The film of the moment of construction, tile by tile, while samples are added. What is not yet taken of
  // a tile that changes is copied first. At most one at a time. `film` must outlive it.
  class Snapshot {
   public:
    explicit Snapshot(SharedFilm& film);
    ~Snapshot();
    Snapshot(const Snapshot&) = delete;
    Snapshot& operator=(const Snapshot&) = delete;

    const RenderTotals& totals() const { return totals_; }
    // To be called once for each tile.
    core::Film::TileSums take(int index);

   private:
    SharedFilm& film_;
    RenderTotals totals_;
  };

 private:
  struct Frozen {
    std::vector<bool> taken;
    std::map<int, core::Film::TileSums> copies;  // of tiles that have changed since, and are not yet taken
  };

  void copy_before_change(const core::PixelRect& rect);

  mutable std::mutex mutex_;
  // Guarded by mutex_.
  core::Film film_;
  RenderTotals totals_;
  std::optional<Frozen> frozen_;  // while there is a snapshot
};

// The samples that each grid tile has.
std::vector<std::uint32_t> samples_of_tiles(const core::Film& film);

}  // namespace tessera::client
