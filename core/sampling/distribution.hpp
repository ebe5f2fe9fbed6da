// A discrete distribution, sampled by inverting its cumulative sums: neighbouring numbers choose neighbouring
// entries, so that stratified numbers stay stratified.
#pragma once

#include <cstddef>
#include <vector>

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

}  // namespace tessera::core
