// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/tally.hpp"

#include <algorithm>

namespace tessera::bench {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace tessera::bench
