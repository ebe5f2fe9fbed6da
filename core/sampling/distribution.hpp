// A discrete distribution, sampled by inverting its cumulative sums: neighbouring numbers choose neighbouring
// entries, so that stratified numbers stay stratified.
#pragma once

#include <cstddef>
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

// A distribution over the cells of a grid, and evenly within each of them: first a row is chosen, then a cell
// of that row.
class GridDistribution {
 public:
  GridDistribution() = default;
  // Weights row by row; not negative. None can be sampled where all are 0.
  GridDistribution(int width, int height, const std::vector<double>& weights);

  struct Choice {
    int x, y;
    Vec2 within;  // where in the cell, in [0, 1)
    double pmf;   // of the cell
  };
  // u in [0, 1). Never a cell of weight 0.
  Choice sample(Vec2 u) const;
  double pmf(int x, int y) const;

 private:
  std::size_t width_ = 0;
  std::vector<double> row_cdf_;   // as cdf_ above
  std::vector<double> cell_cdf_;  // the same for each row by itself; all 0 where the row's weights are
};

}  // namespace tessera::core
