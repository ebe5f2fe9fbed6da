#include "core/geometry/sphere.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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
