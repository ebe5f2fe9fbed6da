// SPDX-License-Identifier: Apache-2.0
// Pearson's test of samples against what a density says to expect.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tessera::test {

// Cells of which too little is expected must be as good as empty. The bound is the 1e-6 quantile of
// chi-square by Wilson and Hilferty's approximation.
inline void expect_chi_square(const std::vector<double>& observed, const std::vector<double>& expected,
                              int least_cells) {
  double chi2 = 0;
  int cells = 0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] < 5) {
      ASSERT_LE(observed[i], 25) << "samples where the density says there are none, in cell " << i;
      continue;
    }
    chi2 += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
    ++cells;
  }
  ASSERT_GE(cells, least_cells) << "too few cells to tell";
  const double k = cells - 1, z = 4.75, t = 1 - 2 / (9 * k) + z * std::sqrt(2 / (9 * k));
  EXPECT_LT(chi2, k * t * t * t);
}

}  // namespace tessera::test
