// SPDX-License-Identifier: Apache-2.0
#include "core/film/fixed_point.hpp"

#include <gtest/gtest.h>

namespace tessera::core {
namespace {

TEST(FixedPoint, RepresentsMultiplesOfTheUnitExactly) {
  EXPECT_EQ(to_fixed_point(0, 0), 0u);
  EXPECT_EQ(to_fixed_point(1, 0), std::uint64_t{1} << kFilmFractionBits);
  EXPECT_EQ(to_fixed_point(3 * kFilmUnit, 0.999), 3u);
}

TEST(FixedPoint, RoundsSoThatTheExpectationIsExact) {
  const double radiance = 5.25 * kFilmUnit;
  std::uint64_t sum = 0;
  for (int i = 0; i < 1000; ++i) sum += to_fixed_point(radiance, i / 1000.0);
  EXPECT_EQ(sum, 5250u);
}

TEST(FixedPoint, SaturatesInsteadOfWrapping) {
  EXPECT_EQ(to_fixed_point(1e30, 0), kFilmSaturated);
  EXPECT_LT(to_fixed_point(2.7e11, 0), kFilmSaturated);
  EXPECT_EQ(add_saturating(kFilmSaturated, 1), kFilmSaturated);
  EXPECT_EQ(add_saturating(kFilmSaturated - 1, 1), kFilmSaturated);
  EXPECT_EQ(add_saturating(kFilmSaturated - 5, 3), kFilmSaturated - 2);
}

}  // namespace
}  // namespace tessera::core
