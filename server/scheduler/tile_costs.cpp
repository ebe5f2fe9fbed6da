// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/tile_costs.hpp"

#include <algorithm>
#include <cmath>

namespace tessera::scheduler {
namespace {

constexpr double kMaxRelative = 64;
// A result changes no cost by more.
constexpr double kMaxChange = 10;
constexpr double kMinCost = 0x1p-40, kMaxCost = 0x1p40;
// The part of the difference that one result corrects.
constexpr double kNewWeight = 0.5;

// NaN gives 1.
double bounded(double ratio) {
  return std::isnan(ratio) ? 1 : std::clamp(ratio, 1 / kMaxChange, kMaxChange);
}

}  // namespace

double TileCosts::cost(int tile) const {
  return std::exp2(static_cast<double>(costs_[tile].log2));
}

double TileCosts::relative(int tile) const {
  const Cost& cost = costs_[tile];
  if (!cost.is_known) return 1;
  const double mean = sum_of_log2_ / static_cast<double>(known_);
  return std::clamp(std::exp2(static_cast<double>(cost.log2) - mean), 1 / kMaxRelative, kMaxRelative);
}

void TileCosts::learn(const std::vector<Part>& parts, double mean_samples) {
  // Of what is not known, it is the mean.
  const double mean = known_ == 0 ? 1 : std::exp2(sum_of_log2_ / static_cast<double>(known_));
  double expected = 0;
  for (const Part& part : parts) expected += part.samples * relative(part.tile);
  const double longer = bounded(mean_samples / expected);
  std::vector<int> tiles;  // a result can have several parts of one
  for (const Part& part : parts) tiles.push_back(part.tile);
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  for (const int tile : tiles) {
    const bool is_known = costs_[tile].is_known;
    set(tile, is_known ? cost(tile) * std::pow(longer, kNewWeight) : mean * longer);
  }
}

void TileCosts::set(int tile, double cost) {
  Cost& stored = costs_.mutable_at(tile);
  if (stored.is_known) sum_of_log2_ -= static_cast<double>(stored.log2);
  known_ += stored.is_known ? 0 : 1;
  stored = {true, static_cast<float>(std::log2(std::clamp(cost, kMinCost, kMaxCost)))};
  sum_of_log2_ += static_cast<double>(stored.log2);
}

}  // namespace tessera::scheduler
