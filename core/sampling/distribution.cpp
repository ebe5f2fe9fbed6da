#include "core/sampling/distribution.hpp"

#include <algorithm>

namespace tessera::core {

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

}  // namespace tessera::core
