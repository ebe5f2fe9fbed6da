// SPDX-License-Identifier: Apache-2.0
// Rays that leave a surface: on a closed convex shape, those that go outwards meet nothing, and those that go
// inwards meet the other side, at every scale and place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

class SpawnedRays : public testing::TestWithParam<std::tuple<float, float>> {
 protected:
  float radius() const { return std::get<0>(GetParam()); }
  Vec3 center() const { return std::get<1>(GetParam()) * radius() * Vec3{0.6f, -0.64f, 0.48f}; }

  void expect_no_acne_and_no_leaks(const Primitives& primitives) {
    const accel::Bvh bvh = accel::Bvh::build(primitives, 1);
    test::Random random(7);
    for (int i = 0; i < 100000; ++i) {
      const Ray ray{center() + random.in_box(0.4f * radius()), random.direction()};
      const Hit hit = bvh.closest_hit(primitives, ray);
      ASSERT_TRUE(hit.found());
      const SurfacePoint point = primitives.surface(ray, hit);
      if (is_at_edge(primitives, hit, point)) continue;
      const Vec3 direction = direction_from(random, point);
      if (dot(direction, point.geometric_normal) == 0) continue;  // neither outwards nor inwards
      const Vec3 outwards = face_toward(direction, point.geometric_normal);

      const Ray out{offset_origin(point, outwards), outwards};
      const Hit acne = bvh.closest_hit(primitives, out);
      ASSERT_FALSE(acne.found()) << test::describe(out, acne);
      ASSERT_FALSE(bvh.any_hit(primitives, out));

      const Ray in{offset_origin(point, -outwards), -outwards};
      const Hit far_side = bvh.closest_hit(primitives, in);
      ASSERT_TRUE(far_side.found()) << test::describe(in, far_side);
      if (!primitives.is_sphere(hit.primitive) && !primitives.is_cylinder(hit.primitive)) {
        ASSERT_NE(far_side.primitive, hit.primitive);
      }
    }
  }

 private:
  // At a sharp edge, the rounding of a point on one side may cross the other side.
  static bool is_at_edge(const Primitives& primitives, const Hit& hit, const SurfacePoint& point) {
    constexpr float kMargin = 2e-3f;
    if (primitives.is_disk(hit.primitive)) return point.uv.y < kMargin;
    return primitives.is_cylinder(hit.primitive) && std::min(point.uv.y, 1 - point.uv.y) < kMargin;
  }
  // Every other one within a degree or so of the surface.
  static Vec3 direction_from(test::Random& random, const SurfacePoint& point) {
    const Vec3 direction = random.direction();
    if (random.below(2) == 0) return direction;
    const Vec3 tangent = direction - dot(direction, point.geometric_normal) * point.geometric_normal;
    return normalize(tangent + random.uniform(-0.02f, 0.02f) * point.geometric_normal);
  }
};

TEST_P(SpawnedRays, OnAMesh) {
  expect_no_acne_and_no_leaks(test::icosphere(2, center(), radius()).primitives());
}

TEST_P(SpawnedRays, OnASphere) {
  Primitives primitives;
  primitives.add_sphere(center(), radius(), 0);
  expect_no_acne_and_no_leaks(primitives);
}

// An oblique elliptic cylinder with caps. Its corners are multiples of a small fraction of its size, so that
// the caps are exactly at its ends.
TEST_P(SpawnedRays, OnACappedCylinder) {
  int exponent = 0;
  std::frexp(radius(), &exponent);
  const float size = std::ldexp(1.0f, exponent), step = size / 256;
  const auto coarse = [step](Vec3 p) {
    return step * Vec3{std::round(p.x / step), std::round(p.y / step), std::round(p.z / step)};
  };
  const Vec3 u = coarse(size * Vec3{0.6f, 0.8f, 0}), v = coarse(size * Vec3{-0.6f, 0.4f, 0.9f});
  const Vec3 axis = coarse(size * Vec3{1.25f, -1, 1.25f}), start = coarse(center() - 0.5f * axis);
  Primitives primitives;
  primitives.add_disk({start, v, u}, 0);
  primitives.add_disk({start + axis, u, v}, 0);
  primitives.add_cylinder({start, axis, u, v, false}, 0);
  expect_no_acne_and_no_leaks(primitives);
}

INSTANTIATE_TEST_SUITE_P(ScalesAndDistances, SpawnedRays,
                         testing::Combine(testing::Values(1e-3f, 1.0f, 1e5f),
                                          testing::Values(0.0f, 10.0f, 1000.0f)));

TEST(OffsetOrigin, MovesToTheSideTheDirectionLeavesFrom) {
  SurfacePoint point;
  point.position = {100, 100, 100};
  point.position_error = {1e-4f, 1e-4f, 1e-4f};
  point.geometric_normal = {0, 0, 1};
  const Vec3 above = offset_origin(point, {1, 0, 0.1f}), below = offset_origin(point, {1, 0, -0.1f});
  EXPECT_GT(above.z, 100 + 1e-4f);
  EXPECT_LT(below.z, 100 - 1e-4f);
  EXPECT_NEAR(above.z, 100, 2e-4f);
  EXPECT_EQ(above.x, 100);
}

}  // namespace
}  // namespace tessera::core
