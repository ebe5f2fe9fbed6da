// SPDX-License-Identifier: Apache-2.0
// A discrete distribution, sampled by inverting its cumulative sums: neighbouring numbers choose neighbouring
// entries, so that stratified numbers stay stratified.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/math/vec3.hpp"

namespace tessera::core {

class DiscreteDistribution {
 public:
  DiscreteDistribution() = default;
  // Weights are not negative; their sum is positive, or there are none.
  explicit DiscreteDistribution(const std::vector<double>& weights);

  bool empty() const { return pmf_.empty(); }
  float pmf(std::size_t index) const { return pmf_[index]; }

  // The entry that u in [0, 1) falls on. Never one of weight 0. Entries rarer than the resolution of u are
  // lost, so it takes more bits than a float has.
  std::size_t sample(double u) const;

 private:
  std::vector<float> pmf_;
  std::vector<double> cdf_;  // cdf_[i] is the probability of the entries up to and with i
};

// Cells side by side that share a whole of 2^31 units, found by what falls on them (Chen and Asau 1974): a
// guide says near which cell to begin. Shares are rounded to units, but none to nothing, and densities are of
// the rounded ones.
class GuidedCells {
 public:
  // Weights row by row; not negative. None can be found in a row where all are 0.
  GuidedCells(std::size_t width, const std::vector<double>& weights);

  struct Place {
    std::size_t cell;
    float within;  // in [0, 1)
  };
  // u in [0, 1). Never a cell of weight 0. Takes more bits than a float has: else rare cells are lost.
  Place find(std::size_t row, double u) const;
  double pmf(std::size_t row, std::size_t cell) const;

 private:
  std::size_t guided_to(std::size_t row, std::uint32_t units) const {
    return guide_[row * guides_ + (units * std::uint64_t{guides_} >> 31)];
  }
  void guide(std::size_t row);

  std::size_t width_ = 0, guides_ = 0;  // of each row
  std::vector<std::uint32_t> begin_;    // of each cell, and where the last one ends
  std::vector<std::uint32_t> guide_;    // the cell where each of `guides_` equal parts of the whole begins
};

// A distribution over the cells of a grid, and evenly within each of them: first a row is chosen, then a cell
// of that row.
class GridDistribution {
 public:
  // Weights row by row; not negative. None can be sampled where all are 0.
  GridDistribution(int width, int height, const std::vector<double>& weights);

  struct Choice {
    int x, y;
    Vec2 within;  // where in the cell, in [0, 1)
  };
  // u in [0, 1). Never a cell of weight 0. Takes more bits than a float has, as GuidedCells::find.
  Choice sample(Vec2Of<double> u) const;
  double pmf(int x, int y) const {
    const auto row = static_cast<std::size_t>(y);
    return rows_.pmf(0, row) * cells_.pmf(row, static_cast<std::size_t>(x));
  }

 private:
  GuidedCells rows_;  // of one row, which has the grid's rows for cells
  GuidedCells cells_;
};

}  // namespace tessera::core
