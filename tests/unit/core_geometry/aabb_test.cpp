// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/aabb.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/geometry/rounding.hpp"

namespace tessera::core {
namespace {

TEST(Aabb, IsEmptyUntilItIncludesSomething) {
  Aabb box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.half_area(), 0);
  box.include(Vec3{1, 2, 3});
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.half_area(), 0);
  box.include(Aabb{});
  EXPECT_EQ(box, (Aabb{{1, 2, 3}, {1, 2, 3}}));
}

TEST(Aabb, HasTheAreaOfItsSides) {
  Aabb box;
  box.include(Vec3{0, 0, 0});
  box.include(Vec3{-1, 2, 3});
  EXPECT_EQ(box.half_area(), 1 * 2 + 2 * 3 + 3 * 1);
}

TEST(Aabb, DoesNotOverflow) {
  Aabb box;
  box.include(Vec3{-3e38f, -3e38f, -3e38f});
  box.include(Vec3{3e38f, 3e38f, 3e38f});
  EXPECT_TRUE(std::isfinite(box.half_area()));
}

TEST(Rounding, NeighbouringFloatsAreThoseOfTheLibrary) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kLargest = std::numeric_limits<float>::max();
  for (const float x : {0.0f, -0.0f, 1e-45f, -1e-45f, 1.0f, -1.0f, 3.7e-39f, 1e30f, kLargest, -kLargest}) {
    EXPECT_EQ(next_float_up(x), std::nextafter(x, kInfinity)) << x;
    EXPECT_EQ(next_float_down(x), std::nextafter(x, -kInfinity)) << x;
  }
  EXPECT_EQ(next_float_up(kInfinity), kInfinity);
  EXPECT_EQ(next_float_down(-kInfinity), -kInfinity);
}

}  // namespace
}  // namespace tessera::core
