// SPDX-License-Identifier: Apache-2.0
// Discrete distributions sampled by inversion of the cumulative sums: neighbouring numbers select
// neighbouring entries, which preserves stratification.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/math/vec3.hpp"

namespace tessera::core::sampling {

class DiscreteDistribution {
 public:
  DiscreteDistribution() = default;
  // Weights are non-negative; their sum is positive unless there are none.
  explicit DiscreteDistribution(const std::vector<double>& weights);

  bool empty() const { return pmf_.empty(); }
  float pmf(std::size_t index) const { return pmf_[index]; }

  // The entry selected by u in [0, 1), never one of weight 0. Entries rarer than the resolution of u are
  // never sampled, so u has more bits than a float.
  std::size_t sample(double u) const;
  // The entry, and a number in [0, 1) that is uniform given the entry: what is left of u.
  struct Sample {
    std::size_t index;
    double rest;
  };
  Sample sample_and_rest(double u) const;

 private:
  std::vector<float> pmf_;
  std::vector<double> cdf_;  // cdf_[i] is the probability of entries 0 to i
};

// Rows of cells that divide a total of 2^31 units, sampled by a guide table (Chen and Asau 1974), which
// gives a cell near the result. Probabilities are rounded to units, but never to 0, and densities are those
// of the rounded probabilities.
class GuidedCells {
 public:
  // Weights row by row; non-negative. A row of zeros cannot be sampled.
  GuidedCells(std::size_t width, const std::vector<double>& weights);

  struct Place {
    std::size_t cell;
    float within;  // in [0, 1)
  };
  // u is in [0, 1), with more bits than a float has: otherwise rare cells are never sampled. Never returns
  // a cell of weight 0.
  Place find(std::size_t row, double u) const;
  double pmf(std::size_t row, std::size_t cell) const;

 private:
  std::size_t guided_to(std::size_t row, std::uint32_t units) const {
    return guide_[row * guides_ + (units * std::uint64_t{guides_} >> 31)];
  }
  void guide(std::size_t row);

  std::size_t width_ = 0, guides_ = 0;  // of each row
  std::vector<std::uint32_t> begin_;    // of each cell, followed by the end of the last one
  std::vector<std::uint32_t> guide_;    // the cell that contains the start of each of `guides_` equal parts
};

// A piecewise-constant distribution over a grid: samples a row, then a cell of that row, then a position in
// the cell.
class GridDistribution {
 public:
  // Weights row by row; non-negative. If all are 0, nothing can be sampled.
  GridDistribution(int width, int height, const std::vector<double>& weights);

  struct Choice {
    int x, y;
    Vec2 within;  // position in the cell, in [0, 1)
  };
  // u is in [0, 1), with more bits than a float has, as in GuidedCells::find. Never returns a cell of
  // weight 0.
  Choice sample(Vec2Of<double> u) const;
  double pmf(int x, int y) const {
    const auto row = static_cast<std::size_t>(y);
    return rows_.pmf(0, row) * cells_.pmf(row, static_cast<std::size_t>(x));
  }

 private:
  GuidedCells rows_;  // a single row whose cells are the grid's rows
  GuidedCells cells_;
};

}  // namespace tessera::core::sampling
