// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/warp.hpp"

#include <gtest/gtest.h>

#include <array>

namespace tessera::core::sampling {
namespace {

constexpr int kSide = 1024;

template <typename Visit>
void over_unit_square(Visit visit) {
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      visit(Vec2{(static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide});
}

TEST(Warp, DiskIsUniform) {
  int inner = 0, right = 0;
  over_unit_square([&](Vec2 u) {
    const Vec2 d = sample_disk(u);
    ASSERT_LE(d.x * d.x + d.y * d.y, 1.00001f);
    inner += d.x * d.x + d.y * d.y < 0.25f;
    right += d.x > 0.5f;
  });
  EXPECT_NEAR(inner / double{kSide * kSide}, 0.25, 0.005);
  EXPECT_NEAR(right / double{kSide * kSide}, 0.1955, 0.005) << "circular segment beyond half the radius";
}

TEST(Warp, HemisphereHasTheCosineDensity) {
  std::array<int, 8> by_cosine_squared{};
  over_unit_square([&](Vec2 u) {
    const Vec3 w = sample_cosine_hemisphere(u);
    ASSERT_NEAR(length(w), 1, 1e-5);
    ASSERT_GT(w.z, 0);
    ++by_cosine_squared[std::min<std::size_t>(7, static_cast<std::size_t>(w.z * w.z * 8))];
  });
  for (const int count : by_cosine_squared) EXPECT_NEAR(count / double{kSide * kSide}, 0.125, 0.005);
  EXPECT_FLOAT_EQ(pdf_cosine_hemisphere(1.0f), 1 / kPi);
  EXPECT_EQ(pdf_cosine_hemisphere(-0.5f), 0);
}

TEST(Warp, SphereIsUniform) {
  std::array<int, 8> by_height{}, by_side{};
  over_unit_square([&](Vec2 u) {
    const Vec3 w = sample_sphere(u);
    ASSERT_NEAR(length(w), 1, 1e-5);
    ++by_height[std::min<std::size_t>(7, static_cast<std::size_t>((w.z + 1) * 4))];
    ++by_side[std::min<std::size_t>(7, static_cast<std::size_t>((w.x + 1) * 4))];
  });
  for (const int count : by_height) EXPECT_NEAR(count / double{kSide * kSide}, 0.125, 0.005);
  for (const int count : by_side) EXPECT_NEAR(count / double{kSide * kSide}, 0.125, 0.005);
}

TEST(Warp, TriangleIsUniform) {
  std::array<int, 4> quarters{};  // the three corners' and the middle one of the midpoint subdivision
  over_unit_square([&](Vec2 u) {
    const Vec2 b = sample_triangle(u);
    const float b0 = 1 - b.x - b.y;
    ASSERT_GE(std::min({b0, b.x, b.y}), -1e-6f);
    ++quarters[b0 > 0.5f ? 0 : b.x > 0.5f ? 1 : b.y > 0.5f ? 2 : 3];
  });
  for (const int count : quarters) EXPECT_NEAR(count / double{kSide * kSide}, 0.25, 0.01);
}

}  // namespace
}  // namespace tessera::core::sampling
