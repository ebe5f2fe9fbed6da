// SPDX-License-Identifier: Apache-2.0
// What a sample of each tile costs, learnt from results: glass costs more than sky. Leases of costly tiles
// get fewer samples, so that they take as long as others. Not thread-safe.
#pragma once

#include <cstddef>
#include <vector>

#include "server/scheduler/tile_table.hpp"

namespace tessera::scheduler {

class TileCosts {
 public:
  explicit TileCosts(int tiles) : costs_(tiles) {}

  // The cost of a sample of this tile beside the geometric mean of all tiles of which something is known,
  // which a few wrong costs change little; 1 if nothing is known of it. In [1/64, 64].
  double relative(int tile) const;

  // A part of a result.
  struct Part {
    int tile = 0;
    double samples = 0;  // in pixel samples, more than 0
  };
  // These parts together took as long as this many samples of the mean cost. Reported times may be wrong or
  // hostile: costs stay finite, and later results correct them.
  void learn(const std::vector<Part>& parts, double mean_samples);

 private:
  struct Cost {
    bool is_known = false;
    float log2 = 0;
  };
  double cost(int tile) const;
  void set(int tile, double cost);

  TileTable<Cost> costs_;
  double sum_of_log2_ = 0;
  std::size_t known_ = 0;
};

}  // namespace tessera::scheduler
