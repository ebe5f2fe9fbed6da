// SPDX-License-Identifier: Apache-2.0
// A film that only counts: for each tile and sample, whether it was added; and who added wrong samples.
// Independent of the scheduler's sets.
#pragma once

#include <cstdint>
#include <map>
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
  bool add(const scheduler::WorkItem& item);
  // A worker has added wrong samples to the tile.
  void spoil(int tile, const scheduler::WorkerId& worker) { spoilt_[tile].insert(worker); }
  void clear(int tile);
  // The tiles with wrong samples, and who added these.
  using Spoilt = std::map<int, std::set<scheduler::WorkerId>>;
  const Spoilt& spoilt() const { return spoilt_; }
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
           spoilers(tile) == other.spoilers(tile);
  }

 private:
  bool fits(const scheduler::WorkItem& item) const;
  std::set<scheduler::WorkerId> spoilers(int tile) const {
    const auto found = spoilt_.find(tile);
    return found == spoilt_.end() ? std::set<scheduler::WorkerId>() : found->second;
  }

  std::vector<double> tile_pixels_;
  std::vector<std::vector<bool>> tiles_;
  Spoilt spoilt_;
};

}  // namespace tessera::simulation
