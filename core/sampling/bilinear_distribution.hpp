// SPDX-License-Identifier: Apache-2.0
// A distribution over a grid whose density is interpolated linearly between the middles of its cells, as
// pictures are, and is even from the outermost middles to the edges.
#pragma once

#include <vector>

#include "core/math/vec3.hpp"
#include "core/sampling/distribution.hpp"

namespace tessera::core {

class BilinearDistribution {
 public:
  // Weights of the cells' middles, row by row; not negative, and not all 0.
  BilinearDistribution(int width, int height, const std::vector<double>& weights);

  // Places are in cells from the first one's corner; densities are per area of a cell.
  struct Sample {
    Vec2 place;
    float density;  // more than 0
  };
  // u in [0, 1). Takes more bits than a float has: else rare cells are lost.
  Sample sample(Vec2Of<double> u) const;
  float density(Vec2 place) const;  // beyond the grid, that of the nearest place of it

 private:
  int width_, height_;
  GridDistribution cells_;
};

}  // namespace tessera::core
