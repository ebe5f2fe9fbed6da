// SPDX-License-Identifier: Apache-2.0
// Disks and cylinders.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/primitives.hpp"
#include "tests/support/near.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

constexpr double kPiD = std::numbers::pi;

std::optional<double> hit_distance(const Disk& disk, const Ray& ray) {
  const auto hit = disk.intersect(ObjectRay(ray));
  return hit ? std::optional(hit->t) : std::nullopt;
}
std::optional<double> hit_distance(const Cylinder& cylinder, const Ray& ray) {
  const auto hit = cylinder.intersect(ObjectRay(ray));
  return hit ? std::optional(hit->t) : std::nullopt;
}

TEST(Disk, IsHitFromBothSidesWithinItsRims) {
  const Disk ring{.center = {1, 2, 3}, .radius_u = {2, 0, 0}, .radius_v = {0, 2, 0}, .inner = 0.5f};
  EXPECT_EQ(hit_distance(ring, {{2.5f, 2, 7}, {0, 0, -2}}), 2);
  EXPECT_EQ(hit_distance(ring, {{1, 0.5f, 0}, {0, 0, 1}}), 3);
  EXPECT_FALSE(hit_distance(ring, {{1.9f, 2, 7}, {0, 0, -1}})) << "through the hole";
  EXPECT_FALSE(hit_distance(ring, {{3.1f, 2, 7}, {0, 0, -1}})) << "beyond the rim";
  EXPECT_FALSE(hit_distance(ring, {{2.5f, 2, 7}, {0, 0, 1}})) << "behind the origin";
  EXPECT_FALSE(hit_distance(ring, {{-5, 2, 3}, {1, 0, 0}})) << "within its plane";
  EXPECT_FALSE(hit_distance(ring, {{2.5f, 2, 3}, {0, 0, 1}})) << "from its surface";
}

TEST(Disk, MayBeAnEllipse) {
  const Disk ellipse{.center = {}, .radius_u = {3, 0, 0}, .radius_v = {1, 1, 0}};
  EXPECT_TRUE(hit_distance(ellipse, {{0.99f, 0.99f, 1}, {0, 0, -1}}));
  EXPECT_TRUE(hit_distance(ellipse, {{-2.99f, 0, 1}, {0, 0, -1}}));
  EXPECT_FALSE(hit_distance(ellipse, {{-0.9f, 0.9f, 1}, {0, 0, -1}}));
  EXPECT_NEAR(ellipse.area(), 3 * kPiD, 1e-6);
}

TEST(Cylinder, IsHitOnItsOutsideAndThroughItsEndsOnItsInside) {
  const Cylinder cylinder({0, 0, 0}, {0, 0, 4}, {2, 0, 0}, {0, 2, 0}, false);
  EXPECT_EQ(hit_distance(cylinder, {{5, 0, 1}, {-1, 0, 0}}), 3);
  EXPECT_EQ(hit_distance(cylinder, {{5, 0, 1}, {-2, 0, 0}}), 1.5);
  EXPECT_EQ(hit_distance(cylinder, {{0, 0, 1}, {0, 1, 0}}), 2) << "from inside";
  EXPECT_EQ(hit_distance(cylinder, {{2, 0, 6}, {-1, 0, -1}}), 4) << "through its end";
  EXPECT_FALSE(hit_distance(cylinder, {{0, 0, -3}, {0, 0, 1}})) << "along its axis";
  EXPECT_FALSE(hit_distance(cylinder, {{5, 0, 4.1f}, {-1, 0, 0}})) << "beyond its end";
  EXPECT_FALSE(hit_distance(cylinder, {{5, 0, 1}, {1, 0, 0}})) << "behind the origin";
}

TEST(Cylinder, FromItsSurfaceOnlyTheOtherSideIsHit) {
  const Cylinder cylinder({0, 0, 0}, {0, 0, 4}, {1, 0, 0}, {0, 1, 0}, false);
  EXPECT_EQ(hit_distance(cylinder, {{1, 0, 1}, {-1, 0, 0}}), 2);
  EXPECT_FALSE(hit_distance(cylinder, {{1, 0, 1}, {1, 0, 0}}));
  EXPECT_FALSE(hit_distance(cylinder, {{1, 0, 1}, {0, 1, 0}}));
}

TEST(Cylinder, ThinAndFarIsHitWhereItIsAimedAt) {
  test::Random random(3);
  for (const float distance : {1e2f, 1e4f, 1e6f})
    for (int i = 0; i < 1000; ++i) {
      const Vec3 middle = distance * random.direction(), axis = random.in_box(0.1f * distance);
      const float radius = 1e-4f * distance * random.uniform(0.01f, 1);
      const Vec3 u = radius * normalize(cross(axis, random.direction()));
      const Cylinder cylinder(middle - 0.5f * axis, axis, u, radius * normalize(cross(axis, u)), false);
      ASSERT_TRUE(hit_distance(cylinder, {{}, middle}));
    }
}

TEST(Cylinder, HasItsArea) {
  EXPECT_NEAR(cylinder_area({0, 0, 3}, {2, 0, 0}, {0, 2, 0}), 2 * kPiD * 2 * 3, 1e-5);
  // The circumference of an ellipse of half-axes 2 and 1 (Gauss-Kummer series).
  EXPECT_NEAR(cylinder_area({0, 0, 1}, {2, 0, 0}, {0, 1, 0}), 9.688448220547675, 1e-5);
}

// What a shape of the scene looks like at a hit, beside the same shape in an instance of another map.
struct Shown {
  Hit hit;
  SurfacePoint point;
  UvDerivatives derivatives;
};
Shown show(const Primitives& primitives, const Ray& ray) {
  const Hit hit = test::brute_force_hit(primitives, ray);
  if (!hit.found()) return {};
  const SurfacePoint point = primitives.surface(ray, hit);
  return {hit, point, primitives.uv_derivatives(hit, point)};
}

void expect_same(const Shown& a, const Shown& b) {
  ASSERT_EQ(a.hit.found(), b.hit.found());
  if (!a.hit.found()) return;
  EXPECT_NEAR(a.hit.t, b.hit.t, 1e-4f * a.hit.t);
  expect_near(a.point.position, b.point.position, 1e-4f);
  expect_near(a.point.geometric_normal, b.point.geometric_normal, 1e-3f);
  EXPECT_NEAR(std::remainder(a.point.uv.x - b.point.uv.x, 1.0f), 0, 1e-3f);
  EXPECT_NEAR(a.point.uv.y, b.point.uv.y, 1e-3f);
  expect_near(a.derivatives.dp_du, b.derivatives.dp_du, 2e-2f);
  expect_near(a.derivatives.dp_dv, b.derivatives.dp_dv, 2e-2f);
}

TEST(Quadrics, AreTheSameInInstancesAsUnderTheirMap) {
  test::Random random(5);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Transform map = test::random_transform(random, 1);
    const bool mirrored = map.determinant() < 0;
    Primitives plain, unit, shown;
    if (i % 2 == 0) {
      unit.add_disk({.inner = 0.3f}, 0);
      plain.add_disk({map.origin, map.x_axis, map.y_axis, 0.3f, mirrored}, 0);
    } else {
      unit.add_cylinder({{}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, false}, 0);
      plain.add_cylinder({map.origin, map.z_axis, map.x_axis, map.y_axis, false}, 0);
    }
    shown.add_object(std::move(unit));
    shown.add_instance({Placement(map), 0});
    const Vec3 origin = random.in_box(4);
    const Ray ray{origin, map.point(random.in_box(0.9f)) - origin};
    const Shown once = show(plain, ray);
    hits += once.hit.found() ? 1 : 0;
    expect_same(once, show(shown, ray));
    if (HasFailure()) return;
  }
  EXPECT_GT(hits, 500);
}

// The derivatives, from hits of neighbouring rays, and the orientation of texture coordinates.
TEST(Quadrics, HaveTheDerivativesOfTheirTextureCoordinates) {
  for (const bool is_disk : {true, false}) {
    Primitives primitives;
    const Vec3 u{0.9f, 0.1f, 0}, v{0.2f, 1.1f, 0.3f};
    if (is_disk) {
      primitives.add_disk({{}, u, v, 0.25f, false}, 0);
    } else {
      primitives.add_cylinder({{}, {0.1f, -0.2f, 1}, u, v, false}, 0);
    }
    const auto at = [&](Vec3 target) { return show(primitives, {{3, 1, 4}, target - Vec3{3, 1, 4}}); };
    const Vec3 target = is_disk ? 0.4f * u + 0.5f * v : 0.8f * u + 0.6f * v + Vec3{0.05f, -0.1f, 0.5f};
    const Shown middle = at(target);
    ASSERT_TRUE(middle.hit.found());
    for (const Vec3 step : {Vec3{2e-3f, 0, 0}, {0, 2e-3f, 0}, {0, 0, 2e-3f}}) {
      const Shown other = at(target + step);
      ASSERT_TRUE(other.hit.found());
      const Vec2 moved{other.point.uv.x - middle.point.uv.x, other.point.uv.y - middle.point.uv.y};
      expect_near(other.point.position - middle.point.position,
                  middle.derivatives.dp_du * moved.x + middle.derivatives.dp_dv * moved.y, 1e-4f);
    }
    expect_near(normalize(cross(middle.derivatives.dp_du, middle.derivatives.dp_dv)),
                middle.point.geometric_normal, 1e-3f);
  }
}

TEST(Quadrics, LieWithinTheirBoundsTightly) {
  test::Random random(6);
  for (int i = 0; i < 300; ++i) {
    const Vec3 center = random.in_box(3), u = random.in_box(1), v = random.in_box(1), axis = random.in_box(1);
    const Disk disk{center, u, v};
    const Cylinder cylinder(center, axis, u, v, false);
    Aabb of_disk, of_cylinder;
    for (int k = 0; k < 2000; ++k) {
      const float angle = static_cast<float>(k) / 2000;
      const Vec3 p = cylinder.position({angle, 0}).rounded();
      of_disk.include(p);
      of_cylinder.include(p);
      of_cylinder.include(cylinder.position({angle, 1}).rounded());
    }
    for (const auto& [box, sampled] : {std::pair{disk.bounds(), of_disk}, {cylinder.bounds(), of_cylinder}})
      for (int a = 0; a < 3; ++a) {
        EXPECT_LE(box.lower[a], sampled.lower[a] + 1e-6f);
        EXPECT_GE(box.upper[a], sampled.upper[a] - 1e-6f);
        EXPECT_NEAR(box.lower[a], sampled.lower[a], 1e-4f);
        EXPECT_NEAR(box.upper[a], sampled.upper[a], 1e-4f);
      }
  }
}

TEST(Quadrics, HaveFrontsThatCanBeFlipped) {
  const auto normal_of = [](const Primitives& primitives, const Ray& ray) {
    return show(primitives, ray).point.geometric_normal;
  };
  for (const bool flipped : {false, true}) {
    Primitives disk, tube;
    disk.add_disk({{}, {1, 0, 0}, {0, 1, 0}, 0, flipped}, 0);
    tube.add_cylinder({{}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, flipped}, 0);
    const float sign = flipped ? -1 : 1;
    expect_near(normal_of(disk, {{0.5f, 0.5f, 2}, {0, 0, -1}}), {0, 0, sign}, 1e-6f);
    expect_near(normal_of(tube, {{3, 0, 0.5f}, {-1, 0, 0}}), {sign, 0, 0}, 1e-6f);
  }
}

}  // namespace
}  // namespace tessera::core
