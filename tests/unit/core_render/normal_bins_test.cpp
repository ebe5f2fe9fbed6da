// SPDX-License-Identifier: Apache-2.0
#include "core/lights/normal_bins.hpp"

#include <gtest/gtest.h>

#include "core/math/lane_array.hpp"
#include "core/math/simd_double.hpp"

namespace tessera::core::lights {
namespace {

TEST(Facing, IsThatOfItsNormals) {
  for (std::uint32_t facing = 0; facing < kAllSides; ++facing)
    for (const Vec2 place : {Vec2{0.1f, 0.1f}, {0.9f, 0.1f}, {0.1f, 0.9f}, {0.9f, 0.9f}, {0.5f, 0.5f}})
      ASSERT_EQ(normal_bin(bin_normal(facing, place)), facing);
}

TEST(Facing, OfNoNormalIsAllSides) {
  EXPECT_EQ(normal_bin(Vec3{}), kAllSides);
  EXPECT_EQ(normal_bin(Vec3{-0.0f, 0, -0.0f}), kAllSides);
}

TEST(Facing, OfEightIsThatOfEach) {
  Vec3Lanes normals;
  for (std::uint32_t facing = 0; facing < kAllSides; ++facing) {
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      normals.set(lane, lane == 3 ? Vec3{} : bin_normal(facing, {0.1f * static_cast<float>(lane), 0.3f}));
    const WordLanes facings(normal_bin(normals.all()));
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) ASSERT_EQ(facings[lane], normal_bin(normals[lane]));
  }
}

}  // namespace
}  // namespace tessera::core::lights
