// SPDX-License-Identifier: Apache-2.0
// Quantises weights to shares of a total number of units.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <numeric>
#include <span>

namespace tessera::core::sampling {

// The start of each weight's share, followed by the end of the last one: one entry more than weights. Every
// non-zero weight gets one unit, and its proportion of the remaining units. Weights are non-negative, and
// at most `whole` of them are non-zero. If all are zero, every start is 0.
template <typename Unit>
void cumulate_shares(std::span<const double> weights, Unit whole, std::span<Unit> begins) {
  assert(begins.size() == weights.size() + 1);
  std::fill(begins.begin(), begins.end(), Unit{0});
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum > 0)) return;
  const auto with_weight = std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0; });
  const double shared = static_cast<double>(whole) - static_cast<double>(with_weight);
  assert(shared >= 0);
  double before = 0;
  std::size_t with_weight_before = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    before += weights[i];
    with_weight_before += weights[i] > 0 ? 1 : 0;
    const auto shared_before = static_cast<std::size_t>(before / sum * shared + 0.5);
    begins[i + 1] = static_cast<Unit>(shared_before + with_weight_before);
  }
}

}  // namespace tessera::core::sampling
