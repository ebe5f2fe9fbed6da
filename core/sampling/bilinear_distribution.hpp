// SPDX-License-Identifier: Apache-2.0
// A distribution over a grid whose density is interpolated bilinearly between cell centres, as images are,
// and is constant from the outermost centres to the edges.
#pragma once

#include <vector>

#include "core/math/vec3.hpp"
#include "core/sampling/distribution.hpp"

namespace tessera::core::sampling {

class BilinearDistribution {
 public:
  // Weights of the cell centres, row by row; non-negative, and not all 0.
  BilinearDistribution(int width, int height, const std::vector<double>& weights);

  // Positions are in cells from the first one's corner; densities are per cell area.
  struct Sample {
    Vec2 place;
    float density;  // positive
  };
  // u is in [0, 1), with more bits than a float has: otherwise rare cells are never sampled.
  Sample sample(Vec2Of<double> u) const;
  float density(Vec2 place) const;  // outside the grid, that of the nearest position

 private:
  int width_, height_;
  GridDistribution cells_;
};

}  // namespace tessera::core::sampling
