// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/sphere.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/math/lane_array.hpp"
#include "core/math/simd_double.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

TEST(Sphere, IsHitAtItsNearerSideFromOutsideAndAtTheFarFromInside) {
  const Sphere sphere{{1, 2, 3}, 2};
  EXPECT_EQ(intersect_sphere({{1, 2, 8}, {0, 0, -1}}, sphere), 3);
  EXPECT_EQ(intersect_sphere({{1, 2, 8}, {0, 0, -2}}, sphere), 1.5);
  EXPECT_EQ(intersect_sphere({{1, 2, 4}, {0, 0, -1}}, sphere), 3);
  EXPECT_EQ(intersect_sphere({{1, 2, 4}, {0, 0, 1}}, sphere), 1);
  EXPECT_EQ(intersect_sphere({{1, 2, 3}, {0, 0, 1}}, sphere), 2);
}

TEST(Sphere, IsHitFromItsCentreInAllDirections) {
  for (const Vec3 center : {Vec3{0, 0, 0}, Vec3{-0.0f, -0.0f, -0.0f}, Vec3{1, 2, 3}})
    for (const float x : {-3.0f, -0.0f, 0.0f, 3.0f})
      for (const float y : {-4.0f, -0.0f, 0.0f, 4.0f})
        EXPECT_EQ(intersect_sphere({center, {x, y, 0}}, {center, 60}),
                  x == 0 && y == 0 ? std::nullopt : std::optional(60 / std::hypot(double{x}, double{y})));
}

TEST(Sphere, IsMissedBesideItAndBehindTheOrigin) {
  const Sphere sphere{{0, 0, 0}, 1};
  EXPECT_FALSE(intersect_sphere({{0, 0, 3}, {0, 0, 1}}, sphere));
  EXPECT_FALSE(intersect_sphere({{1.0000001f, 0, 3}, {0, 0, -1}}, sphere));
}

TEST(Sphere, FromItsSurfaceOnlyTheFarSideIsHit) {
  const Sphere sphere{{0, 0, 0}, 1};
  EXPECT_FALSE(intersect_sphere({{0, 0, 1}, {0, 0, 1}}, sphere));
  EXPECT_FALSE(intersect_sphere({{0, 0, 1}, {1, 0, 0}}, sphere));
  EXPECT_EQ(intersect_sphere({{0, 0, 1}, {0, 0, -1}}, sphere), 2);
}

TEST(Sphere, SmallAndFarIsHitWhereItIsAimedAt) {
  test::Random random(3);
  for (const float distance : {1e2f, 1e4f, 1e6f}) {
    for (int i = 0; i < 1000; ++i) {
      const Sphere sphere{distance * random.direction(), 1e-3f * distance * random.uniform(0.01f, 1)};
      const Vec3 origin = random.in_box(1);
      const auto t = intersect_sphere({origin, sphere.center - origin}, sphere);
      ASSERT_TRUE(t);
      const Vec3d to_center = Vec3d(sphere.center - origin);
      const Vec3d p = Vec3d(origin) + *t * to_center;
      EXPECT_NEAR(length(p - Vec3d(sphere.center)) / static_cast<double>(sphere.radius), 1, 1e-6);
      EXPECT_LT(*t, 1);
    }
  }
}

TEST(Sphere, GrazingRaysAreDecidedToTheLastBitOfFloat) {
  const Sphere sphere{{0, 0, 0}, 1};
  const float below = std::nextafter(1.0f, 0.0f), above = std::nextafter(1.0f, 2.0f);
  EXPECT_TRUE(intersect_sphere({{below, 0, 100}, {0, 0, -1}}, sphere));
  EXPECT_TRUE(intersect_sphere({{1, 0, 100}, {0, 0, -1}}, sphere));
  EXPECT_FALSE(intersect_sphere({{above, 0, 100}, {0, 0, -1}}, sphere));
}

TEST(Sphere, WithoutASurfaceIsNeverHit) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  for (const float radius : {0.0f, -1.0f, nan, infinity}) {
    EXPECT_FALSE(intersect_sphere({{0, 0, 3}, {0, 0, -1}}, {{0, 0, 0}, radius})) << radius;
  }
  EXPECT_FALSE(intersect_sphere({{0, 0, 3}, {0, 0, -1}}, {{nan, 0, 0}, 1}));
  EXPECT_FALSE(intersect_sphere({{0, 0, 3}, {0, 0, 0}}, {{0, 0, 0}, 1}));
  EXPECT_FALSE(intersect_sphere({{0, 0, nan}, {0, 0, -1}}, {{0, 0, 0}, 1}));
}

// Rays that meet, miss, leave and touch spheres, some of which have no surface.
TEST(Sphere, EightAtOnceAreToTheBitWhatEachIsAlone) {
  test::Random random(6);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    Vec3Lanes origins, directions, centers;
    FloatLanes radii;
    std::array<std::optional<double>, kLaneCount> alone;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const Sphere sphere{random.in_box(1), random.below(20) == 0 ? 0 : random.uniform(0.1f, 2)};
      const bool from_surface = random.below(4) == 0;
      const bool from_center = random.below(16) == 0;
      const Vec3 origin = from_center    ? sphere.center
                          : from_surface ? sphere.center + random.direction() * sphere.radius
                                         : random.in_box(2);
      const Vec3 direction = random.below(20) == 0 ? Vec3{} : random.in_box(1);
      origins.set(lane, origin), directions.set(lane, direction);
      centers.set(lane, sphere.center), radii.set(lane, sphere.radius);
      alone[lane] = intersect_sphere(Ray{origin, direction}, sphere);
    }
    using Wide = Vec3dOf<DoubleN>;
    const auto [found, t] =
        intersect_sphere<FloatN>(Wide(origins.all()), Wide(directions.all()), {centers.all(), radii.all()});
    alignas(32) double distances[kLaneCount];
    t.low.store(distances);
    t.high.store(distances + 4);
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      ASSERT_EQ((found.bits() >> lane & 1) != 0, alone[lane].has_value());
      if (!alone[lane]) continue;
      ASSERT_EQ(distances[lane], *alone[lane]);
      ++hits;
    }
  }
  EXPECT_GT(hits, 40000);
}

TEST(SphereUv, RunsEastwardsAndNorthwards) {
  const auto expect_uv = [](Vec3 normal, float u, float v) {
    const Vec2 uv = sphere_uv(normal);
    EXPECT_NEAR(uv.x, u, 1e-6f);
    EXPECT_NEAR(uv.y, v, 1e-6f);
  };
  expect_uv({1, 0, 0}, 0, 0.5f);
  expect_uv({0, 0, -1}, 0.25f, 0.5f);
  expect_uv({-1, 0, 0}, 0.5f, 0.5f);
  expect_uv({0, 0, 1}, 0.75f, 0.5f);
  expect_uv({0, 1, 0}, 0, 1);
  expect_uv({0, -1, 0}, 0, 0);
  expect_uv(normalize(Vec3{1, 1, 0}), 0, 0.75f);
}

TEST(SphereUv, StaysInsideItsRange) {
  test::Random random(4);
  for (int i = 0; i < 100000; ++i) {
    Vec3 normal = random.direction();
    if (i % 2 == 0) normal.z = random.uniform(-1e-7f, 1e-7f);
    const Vec2 uv = sphere_uv(normal);
    ASSERT_TRUE(uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y <= 1) << uv.x << " " << uv.y;
  }
  EXPECT_EQ(sphere_uv({1, 0, 1e-12f}).x, 0);  // just below 1 rounds to 1, which is 0
}

}  // namespace
}  // namespace tessera::core
