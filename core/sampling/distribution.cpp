// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/distribution.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include "core/sampling/shares.hpp"

namespace tessera::core::sampling {
namespace {

constexpr std::uint32_t kWhole = std::uint32_t{1} << 31;
constexpr double kUnit = 1.0 / kWhole;
constexpr std::size_t kCellsPerGuide = 4;

std::vector<double> sums_of_rows(std::size_t width, const std::vector<double>& weights) {
  std::vector<double> sums;
  for (auto row = weights.begin(); row != weights.end(); row += static_cast<std::ptrdiff_t>(width))
    sums.push_back(std::accumulate(row, row + static_cast<std::ptrdiff_t>(width), 0.0));
  return sums;
}

}  // namespace

DiscreteDistribution::DiscreteDistribution(const std::vector<double>& weights) {
  pmf_.reserve(weights.size());
  cdf_.reserve(weights.size());
  double sum = 0;
  for (const double w : weights) cdf_.push_back(sum += w);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    cdf_[i] /= sum;
    pmf_.push_back(static_cast<float>(weights[i] / sum));
  }
}

std::size_t DiscreteDistribution::sample(double u) const {
  const auto found = std::upper_bound(cdf_.begin(), cdf_.end(), u);
  return static_cast<std::size_t>(found - cdf_.begin());
}

DiscreteDistribution::Sample DiscreteDistribution::sample_and_rest(double u) const {
  constexpr double kBelowOne = 1 - 0x1p-53;
  const std::size_t index = sample(u);
  const double begin = index > 0 ? cdf_[index - 1] : 0;
  return {index, std::min((u - begin) / (cdf_[index] - begin), kBelowOne)};
}

GuidedCells::GuidedCells(std::size_t width, const std::vector<double>& weights)
    : width_(width), guides_((width + kCellsPerGuide - 1) / kCellsPerGuide) {
  const std::size_t rows = weights.size() / width;
  begin_.resize(rows * (width + 1));
  guide_.resize(rows * guides_);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::span<std::uint32_t> begins{begin_.data() + row * (width + 1), width + 1};
    cumulate_shares<std::uint32_t>({weights.data() + row * width, width}, kWhole, begins);
    if (begins.back() == kWhole) guide(row);
  }
}

void GuidedCells::guide(std::size_t row) {
  const std::uint32_t* begin = begin_.data() + row * (width_ + 1);
  std::uint32_t cell = 0;
  for (std::size_t g = 0; g < guides_; ++g) {
    const std::uint64_t part_begin = (g * std::uint64_t{kWhole} + guides_ - 1) / guides_;
    while (begin[cell + 1] <= part_begin) ++cell;
    guide_[row * guides_ + g] = cell;
  }
}

GuidedCells::Place GuidedCells::find(std::size_t row, double u) const {
  constexpr float kBelowOne = 1 - 0x1p-24f;
  const double units = u * kWhole;
  const auto whole_units = static_cast<std::uint32_t>(units);
  const std::uint32_t* begin = begin_.data() + row * (width_ + 1);
  std::size_t cell = guided_to(row, whole_units);
  while (begin[cell + 1] <= whole_units) ++cell;
  const double share = begin[cell + 1] - begin[cell];
  return {cell, std::min(static_cast<float>((units - begin[cell]) / share), kBelowOne)};
}

double GuidedCells::pmf(std::size_t row, std::size_t cell) const {
  const std::uint32_t* begin = begin_.data() + row * (width_ + 1) + cell;
  return (begin[1] - begin[0]) * kUnit;
}

GridDistribution::GridDistribution(int width, int height, const std::vector<double>& weights)
    : rows_(static_cast<std::size_t>(height), sums_of_rows(static_cast<std::size_t>(width), weights)),
      cells_(static_cast<std::size_t>(width), weights) {}

GridDistribution::Choice GridDistribution::sample(Vec2Of<double> u) const {
  const GuidedCells::Place row = rows_.find(0, u.y), cell = cells_.find(row.cell, u.x);
  return {static_cast<int>(cell.cell), static_cast<int>(row.cell), {cell.within, row.within}};
}

}  // namespace tessera::core::sampling
