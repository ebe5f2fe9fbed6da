// SPDX-License-Identifier: Apache-2.0
// A film that only counts: for each tile and sample, whether it was added, and whether it was wrong.
// Independent of the scheduler's sets.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::simulation {

class ModelFilm {
 public:
  ModelFilm() = default;
  explicit ModelFilm(const scheduler::JobShape& shape);

  // Never removes samples. Afterwards all tiles are to get at least so many, and these at least theirs.
  void extend(std::uint32_t spp, const std::vector<scheduler::TileTarget>& tiles = {});
  // Likewise, to the targets of a shape.
  void extend(const scheduler::JobShape& shape);
  // Each tile is to get as many samples as the shape says. The film has no others.
  void set_targets(const scheduler::JobShape& shape);
  // False if some of the samples were added before, or are outside the film.
  bool add(const scheduler::WorkItem& item, bool wrong_bits = false);
  void clear(int tile);
  // A tile with wrong samples, if there is one.
  std::optional<int> spoilt_tile() const;
  // Whether the film has all of the samples, or some of them. False for samples outside the film.
  bool has(const scheduler::WorkItem& item) const;
  bool has_any(const scheduler::WorkItem& item) const;
  bool complete() const;
  // 0 for a tile outside the film.
  double pixel_samples(const scheduler::WorkItem& item) const {
    if (item.tile < 0 || item.tile >= tile_count()) return 0;
    return tile_pixels_[static_cast<std::size_t>(item.tile)] * item.samples.count();
  }
  int tile_count() const { return static_cast<int>(tiles_.size()); }
  scheduler::IntervalSet done(int tile) const;
  // The number of samples in the tile.
  std::uint64_t count(int tile) const;
  // Copies one tile from another film of the same job, which may have more samples by now.
  void copy_tile(int tile, const ModelFilm& from);
  bool same_tile(int tile, const ModelFilm& other) const {
    return tiles_[static_cast<std::size_t>(tile)] == other.tiles_[static_cast<std::size_t>(tile)] &&
           spoilt_.contains(tile) == other.spoilt_.contains(tile);
  }

 private:
  bool fits(const scheduler::WorkItem& item) const;

  std::vector<double> tile_pixels_;
  std::vector<std::vector<bool>> tiles_;
  std::set<int> spoilt_;
};

}  // namespace tessera::simulation
