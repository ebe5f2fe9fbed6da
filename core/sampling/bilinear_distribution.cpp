// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/bilinear_distribution.hpp"

#include <algorithm>
#include <cmath>

namespace tessera::core::sampling {
namespace {

// Linear interpolation is a sum of tent functions, one at each cell centre, which end at the neighbouring
// centres. Those of the outermost cells are reflected at the edge, which makes their sum constant there. At
// the foot of a tent, for u = 0, the density might be 0.
float under_tent(int cell, float u, int cells) {
  constexpr float kMin = 0x1p-25f;
  const float from_middle = u < 0.5f ? std::sqrt(2 * std::max(u, kMin)) - 1 : 1 - std::sqrt(2 * (1 - u));
  const float place = static_cast<float>(cell) + 0.5f + from_middle;
  const auto end = static_cast<float>(cells);
  return place < 0 ? -place : place > end ? 2 * end - place : place;
}

// The two cells whose tents cover a position, and the value of the second one's tent. NaN also maps to
// valid cells.
struct Tents {
  Tents(float place, int cells) {
    const float from_first = larger(0.0f, smaller(place - 0.5f, static_cast<float>(cells - 1)));
    first = static_cast<int>(from_first);
    second = std::min(first + 1, cells - 1);
    of_second = static_cast<double>(from_first) - first;
  }
  double interpolate(double at_first, double at_second) const {
    return at_first * (1 - of_second) + at_second * of_second;
  }

  int first, second;
  double of_second;
};

}  // namespace

BilinearDistribution::BilinearDistribution(int width, int height, const std::vector<double>& weights)
    : width_(width), height_(height), cells_(width, height, weights) {}

BilinearDistribution::Sample BilinearDistribution::sample(Vec2Of<double> u) const {
  const GridDistribution::Choice cell = cells_.sample(u);
  const Vec2 place{under_tent(cell.x, cell.within.x, width_), under_tent(cell.y, cell.within.y, height_)};
  return {place, density(place)};
}

float BilinearDistribution::density(Vec2 place) const {
  const Tents columns(place.x, width_), rows(place.y, height_);
  const auto in_row = [&](int row) {
    return columns.interpolate(cells_.pmf(columns.first, row), cells_.pmf(columns.second, row));
  };
  return static_cast<float>(rows.interpolate(in_row(rows.first), in_row(rows.second)));
}

}  // namespace tessera::core::sampling
