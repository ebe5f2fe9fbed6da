// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/triangle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

const TriangleCorners kUnitTriangle{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};

std::optional<TriangleHit> shoot(Vec3 origin, Vec3 direction,
                                 const TriangleCorners& corners = kUnitTriangle) {
  return intersect_triangle(ShearedRay(Ray{origin, direction}), corners);
}

TEST(Triangle, IsHitFromBothSidesAtTheRightPlace) {
  for (const float side : {2.0f, -2.0f}) {
    const auto hit = shoot({0.25f, 0.5f, side}, {0, 0, -side});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->t, 1);
    EXPECT_EQ(hit->b1, 0.25f);
    EXPECT_EQ(hit->b2, 0.5f);
  }
}

TEST(Triangle, IsMissedBesideItAndBehindTheOrigin) {
  EXPECT_FALSE(shoot({0.75f, 0.5f, 1}, {0, 0, -1}));
  EXPECT_FALSE(shoot({-0.01f, 0.5f, 1}, {0, 0, -1}));
  EXPECT_FALSE(shoot({0.25f, 0.5f, 1}, {0, 0, 1}));
}

TEST(Triangle, EdgesAndCornersBelongToIt) {
  for (const Vec3 target :
       {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0.5f, 0, 0}, Vec3{0.5f, 0.5f, 0}}) {
    EXPECT_TRUE(shoot(target + Vec3{0, 0, 1}, {0, 0, -1}));
  }
}

TEST(Triangle, IsNotHitByRaysThatStartOnIt) {
  test::Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 w = random.weights();
    EXPECT_FALSE(shoot({w.x, w.y, 0}, random.direction()));
  }
}

TEST(Triangle, IsNotHitByRaysWithinItsPlane) {
  EXPECT_FALSE(shoot({-1, 0.25f, 0}, {1, 0, 0}));
  EXPECT_FALSE(shoot({-1, 0, 0}, {1, 0, 0}));
}

TEST(Triangle, HitsAgreeWithExtendedPrecision) {
  test::Random random(2);
  int hits = 0;
  for (int i = 0; i < 100000; ++i) {
    const TriangleCorners corners{random.in_box(1), random.in_box(1), random.in_box(1)};
    const Vec3 origin = random.in_box(2), direction = random.direction();
    const auto hit = shoot(origin, direction, corners);
    if (!hit) continue;
    ++hits;
    // In long double: the distance to the plane, from the normal.
    const Vec3d n = area_normal(corners);
    const auto along = [&](Vec3d v) {
      return static_cast<long double>(n.x) * v.x + static_cast<long double>(n.y) * v.y +
             static_cast<long double>(n.z) * v.z;
    };
    const long double approach = along(Vec3d(direction));
    if (std::fabs(approach) < 1e-6L) continue;
    const long double t = along(Vec3d(corners[0]) - Vec3d(origin)) / approach;
    EXPECT_NEAR(static_cast<double>(hit->t / t), 1, 1e-7);
  }
  EXPECT_GT(hits, 1000);
}

TEST(Triangle, WithoutAreaCannotBeHit) {
  const Vec3 a{0.1f, 0.2f, 0.3f}, b{0.7f, 0.3f, 0.9f};
  EXPECT_FALSE(can_be_hit({a, a, a}));
  EXPECT_FALSE(can_be_hit({a, b, a}));
  EXPECT_FALSE(can_be_hit({a, b, b}));
  EXPECT_FALSE(can_be_hit({Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{3, 3, 3}}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(can_be_hit({a, b, Vec3{nan, 0, 0}}));
  EXPECT_FALSE(can_be_hit({a, b, Vec3{0, std::numeric_limits<float>::infinity(), 0}}));
}

TEST(Triangle, HasItsNormalAtAnyScale) {
  for (const float scale : {1e-30f, 1e-20f, 1e-6f, 1.0f, 1e5f, 1e15f, 1e30f}) {
    const TriangleCorners corners{Vec3{0, 0, 0}, Vec3{scale, 0, 0}, Vec3{0, 0, scale * 1e-6f}};
    ASSERT_TRUE(can_be_hit(corners)) << scale;
    const Vec3d n = area_normal(corners);
    EXPECT_EQ(((1 / length(n)) * n).rounded(), (Vec3{0, -1, 0})) << scale;
  }
}

TEST(Triangle, RaysThatAreNotRaysHitNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, infinity, -infinity}) {
    EXPECT_FALSE(shoot({0.2f, 0.2f, bad}, {0, 0, 1}));
    EXPECT_FALSE(shoot({0.2f, 0.2f, 1}, {bad, bad, bad}));
    EXPECT_FALSE(shoot({0.2f, 0.2f, 1}, {0, bad, -1}));
  }
  EXPECT_FALSE(shoot({0.2f, 0.2f, 1}, {0, 0, 0}));
}

}  // namespace
}  // namespace tessera::core
