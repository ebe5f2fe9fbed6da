#include "core/sampling/distribution.hpp"

#include <algorithm>
#include <span>

namespace tessera::core {
namespace {

// Cumulates `weights` in place, up to exactly 1, and answers what they summed to.
double cumulate(std::span<double> weights) {
  double sum = 0;
  for (double& w : weights) w = sum += w;
  if (sum > 0)
    for (double& w : weights) w /= sum;
  return sum;
}

double probability(std::span<const double> cdf, std::size_t index) {
  return index > 0 ? cdf[index] - cdf[index - 1] : cdf[index];
}

struct Inverted {
  std::size_t index;
  float within;
};

// Where u falls, and how far into that entry.
Inverted invert(std::span<const double> cdf, float u) {
  constexpr float kBelowOne = 1 - 0x1p-24f;
  const auto value = static_cast<double>(u);
  const auto index = static_cast<std::size_t>(std::upper_bound(cdf.begin(), cdf.end(), value) - cdf.begin());
  const double begin = index > 0 ? cdf[index - 1] : 0;
  return {index, std::min(static_cast<float>((value - begin) / (cdf[index] - begin)), kBelowOne)};
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

GridDistribution::GridDistribution(int width, int height, const std::vector<double>& weights)
    : width_(static_cast<std::size_t>(width)), cell_cdf_(weights) {
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    row_cdf_.push_back(cumulate(std::span(cell_cdf_).subspan(y * width_, width_)));
  cumulate(row_cdf_);
}

GridDistribution::Choice GridDistribution::sample(Vec2 u) const {
  const auto [y, within_y] = invert(row_cdf_, u.y);
  const auto row = std::span(cell_cdf_).subspan(y * width_, width_);
  const auto [x, within_x] = invert(row, u.x);
  return {static_cast<int>(x),
          static_cast<int>(y),
          {within_x, within_y},
          probability(row_cdf_, y) * probability(row, x)};
}

double GridDistribution::pmf(int x, int y) const {
  const auto row = static_cast<std::size_t>(y);
  return probability(row_cdf_, row) *
         probability(std::span(cell_cdf_).subspan(row * width_, width_), static_cast<std::size_t>(x));
}

}  // namespace tessera::core
