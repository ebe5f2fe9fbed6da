// SPDX-License-Identifier: Apache-2.0
// Objects shown by instances: where rays meet them, what surface they find there, and that the rays which
// leave it neither meet it again nor slip through.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

// A bumpy closed mesh with normals and texture coordinates, and a ball.
struct Body {
  Body() : mesh(test::icosphere(2, {0.2f, 0.1f, -0.1f}, 1)) {
    test::Random random(3);
    for (const Vec3 p : mesh.positions) {
      normals.push_back(normalize(p + random.in_box(0.2f)));
      uvs.push_back({random.uniform(-1, 1), random.uniform(-1, 1)});
    }
  }

  // As the map moves it; what is mirrored keeps its outside.
  Primitives moved(const Transform& transform) const {
    std::vector<Vec3> positions, moved_normals;
    const Placement placement(transform);
    for (const Vec3 p : mesh.positions) positions.push_back(transform.point(p));
    for (const Vec3 n : normals) moved_normals.push_back(placement.normal(Vec3d(n)).rounded());
    auto triangles = mesh.triangles;
    if (transform.determinant() < 0)
      for (auto& triangle : triangles) std::swap(triangle[1], triangle[2]);
    Primitives primitives;
    primitives.add_mesh(positions, moved_normals, uvs, triangles, {0});
    return primitives;
  }

  Primitives placed(const Transform& transform) const {
    Primitives primitives;
    primitives.add_object(moved({}));
    primitives.add_instance({Placement(transform), 0});
    return primitives;
  }

  test::Mesh mesh;
  std::vector<Vec3> normals;
  std::vector<Vec2> uvs;
};

void expect_same_bits(const SurfacePoint& a, const SurfacePoint& b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.position_error, b.position_error);
  EXPECT_EQ(a.geometric_normal, b.geometric_normal);
  EXPECT_EQ(a.shading_normal, b.shading_normal);
  EXPECT_EQ(a.uv, b.uv);
}

TEST(Instance, WhereTheObjectWasModelledIsTheObjectToTheBit) {
  const Body body;
  Primitives flat = body.moved({}), object = body.moved({});
  for (Primitives* each : {&flat, &object}) each->add_sphere({0.5f, 1.5f, 0}, 0.6f, 0);
  Primitives shown;
  shown.add_object(std::move(object));
  shown.add_instance({Placement({}), 0});
  const accel::Bvh flat_bvh = accel::Bvh::build(flat, 1), shown_bvh = accel::Bvh::build(shown, 1);
  test::Random random(1);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray{random.in_box(3), random.direction()};
    const Hit expected = flat_bvh.closest_hit(flat, ray);
    Hit hit = shown_bvh.closest_hit(shown, ray);
    ASSERT_EQ(hit.found(), expected.found());
    if (!hit.found()) continue;
    ++hits;
    ASSERT_EQ(hit.instance, 0u);
    expect_same_bits(shown.surface(ray, hit), flat.surface(ray, expected));
    if (!flat.is_sphere(expected.primitive)) {
      const SurfacePoint point = flat.surface(ray, expected);
      EXPECT_EQ(shown.tangents(hit, point).along_u, flat.tangents(expected, point).along_u);
      EXPECT_EQ(shown.tangents(hit, point).along_v, flat.tangents(expected, point).along_v);
    }
    hit.instance = kNoInstance;
    ASSERT_TRUE(test::identical(hit, expected));
    if (HasFailure()) return;
  }
  EXPECT_GT(hits, 1000);
}

TEST(Instance, IsTheMovedObjectButForRounding) {
  const Body body;
  test::Random random(2);
  int hits = 0;
  for (int t = 0; t < 50; ++t) {
    const Transform transform = test::random_transform(random, 5);
    const Primitives moved = body.moved(transform), shown = body.placed(transform);
    const accel::Bvh moved_bvh = accel::Bvh::build(moved, 1), shown_bvh = accel::Bvh::build(shown, 1);
    for (int i = 0; i < 400; ++i) {
      const Vec3 from = transform.origin + random.in_box(3);
      const Ray ray{from, test::point_of(moved, random) - from};
      const Hit expected = moved_bvh.closest_hit(moved, ray), hit = shown_bvh.closest_hit(shown, ray);
      // Rounding may decide at edges.
      if (expected.primitive != hit.primitive || std::min(hit.b1, hit.b2) < 1e-3f) continue;
      if (!hit.found()) continue;
      const SurfacePoint a = shown.surface(ray, hit), b = moved.surface(ray, expected);
      if (std::fabs(dot(b.geometric_normal, normalize(ray.direction))) < 0.1f) continue;  // grazing
      ++hits;
      ASSERT_NEAR(hit.t, expected.t, 1e-4f);
      ASSERT_NEAR(length(a.position - b.position), 0, 1e-4f);
      ASSERT_NEAR(length(a.geometric_normal - b.geometric_normal), 0, 1e-4f);
      // Normals of unit length that are moved before they are interpolated have other weights.
      const Vec3 modelled =
          shown.objects()[0].surface({}, {hit.t, hit.primitive, hit.b1, hit.b2}).shading_normal;
      Vec3 turned = normalize(Placement(transform).normal(Vec3d(modelled)).rounded());
      // A map that is not uniform can move a normal to the other side of its surface, where it is flipped.
      if (dot(turned, a.geometric_normal) < 0) turned = -turned;
      ASSERT_NEAR(length(a.shading_normal - turned), 0, 1e-5f);
      ASSERT_NEAR(a.uv.x, b.uv.x, 2e-3f);
      const Tangents of_shown = shown.tangents(hit, a), of_moved = moved.tangents(expected, b);
      ASSERT_NEAR(length(of_shown.along_u - of_moved.along_u), 0, 1e-3f);
      ASSERT_NEAR(length(of_shown.along_v - of_moved.along_v), 0, 1e-3f);
    }
  }
  EXPECT_GT(hits, 3000);
}

TEST(Instance, OfABallTurnsItsTextureAndStretchesIt) {
  Primitives object;
  object.add_sphere({0, 0, 0}, 1, 4);
  Primitives shown;
  shown.add_object(std::move(object));
  shown.add_instance({Placement(compose(scaling({2, 1, 1}), rotation({0, 1, 0}, 90))), 0});
  shown.add_instance({Placement(translation({0, 9, 0})), 0, 7});
  const accel::Bvh bvh = accel::Bvh::build(shown, 1);
  const Ray ray{{5, 0, 0}, {-1, 0, 0}};
  const Hit hit = bvh.closest_hit(shown, ray);
  EXPECT_NEAR(hit.t, 3, 1e-6f);
  const SurfacePoint point = shown.surface(ray, hit);
  EXPECT_NEAR(length(point.position - Vec3{2, 0, 0}), 0, 1e-6f);
  EXPECT_NEAR(point.uv.x, 0.75f, 1e-6f) << "what was at -z is at +x now";
  EXPECT_NEAR(length(shown.tangents(hit, point).along_v - Vec3{0, 1, 0}), 0, 1e-6f);
  EXPECT_EQ(shown.material(hit), 4u);
  EXPECT_EQ(shown.material(bvh.closest_hit(shown, {{5, 9, 0}, {-1, 0, 0}})), 7u);
  const Ray oblique{{3, 3, 0}, Vec3{1, 0.7f, 0} - Vec3{3, 3, 0}};
  const SurfacePoint side = shown.surface(oblique, bvh.closest_hit(shown, oblique));
  const Vec3 p = side.position;
  EXPECT_NEAR(length(side.geometric_normal - normalize(Vec3{p.x / 4, p.y, p.z})), 0, 1e-5f);
}

TEST(Instance, SettlesTies) {
  const test::Mesh mesh = test::icosphere(0, {}, 1);
  Primitives primitives;
  primitives.add_object(mesh.primitives());
  for (int i = 0; i < 6; ++i) primitives.add_instance({Placement({}), 0});
  const Ray ray{{0, 0, 0}, {0.3f, 0.5f, 0.8f}};
  EXPECT_EQ(accel::Bvh::build(primitives, 1).closest_hit(primitives, ray).instance, 0u);
  Primitives with_own = mesh.primitives();
  with_own.add_object(mesh.primitives());
  with_own.add_instance({Placement({}), 0});
  EXPECT_EQ(accel::Bvh::build(with_own, 1).closest_hit(with_own, ray).instance, kNoInstance);
}

TEST(Instance, CannotBePlacedWhereSpaceIsFlattened) {
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(Placement::can_place(scaling({1e-9f, 1, 1e9f})));
  EXPECT_TRUE(Placement::can_place(scaling({-1, 1, 1})));
  EXPECT_FALSE(Placement::can_place(scaling({1, 0, 1})));
  EXPECT_FALSE(Placement::can_place(scaling({1, 1e-16f, 1})));
  EXPECT_FALSE(Placement::can_place({{1, 0, 0}, {1, 1e-12f, 0}, {0, 0, 1}, {}}));
  EXPECT_FALSE(Placement::can_place({{infinity, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}}));
  EXPECT_FALSE(Placement::can_place(translation({0, infinity, 0})));
}

TEST(Instance, IsBoundedClosely) {
  const Body body;
  test::Random random(8);
  for (int i = 0; i < 20; ++i) {
    const Transform transform = test::random_transform(random, 5);
    const Primitives shown = body.placed(transform), moved = body.moved(transform);
    const Aabb box = shown.bounds(0);
    Aabb exact;
    for (std::uint32_t p = 0; p < moved.count(); ++p) exact.include(moved.bounds(p));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(box.lower[axis], exact.lower[axis] + 1e-6f);
      EXPECT_GE(box.upper[axis], exact.upper[axis] - 1e-6f);
      EXPECT_LE(box.extent(axis), 1.4 * exact.extent(axis));
    }
  }
}

// How an instance is scaled, and how far from the origin it stands, in units of its size.
class SpawnedRaysOfInstances : public testing::TestWithParam<std::tuple<Vec3, float>> {
 protected:
  Transform transform() const {
    const Vec3 scale = std::get<0>(GetParam());
    const float size = std::max({std::fabs(scale.x), std::fabs(scale.y), std::fabs(scale.z)});
    const Transform turned =
        compose(rotation({0.3f, 1, -0.5f}, 63), compose(scaling(scale), rotation({1, 0.2f, 0.4f}, 31)));
    return compose(translation(std::get<1>(GetParam()) * size * Vec3{0.6f, -0.64f, 0.48f}), turned);
  }

  void expect_no_acne_and_no_leaks(Primitives object) {
    const bool is_ball = object.is_sphere(0);
    const Placement placement(transform());
    Primitives shown;
    shown.add_object(std::move(object));
    shown.add_instance({placement, 0});
    const accel::Bvh bvh = accel::Bvh::build(shown, 1);
    test::Random random(7);
    for (int i = 0; i < 20000; ++i) {
      const Vec3 from = placement.point(Vec3d(random.in_box(0.4f))).rounded();
      const Ray ray{from, placement.vector(Vec3d(random.direction())).rounded()};
      const Hit hit = bvh.closest_hit(shown, ray);
      ASSERT_TRUE(hit.found());
      const SurfacePoint point = shown.surface(ray, hit);
      ASSERT_GT(dot(point.geometric_normal, ray.direction), 0) << "seen from inside, mirrored or not";
      const Vec3 direction = random.direction();
      const Vec3 outwards = face_toward(direction, point.geometric_normal);
      const Ray out{offset_origin(point, outwards), outwards};
      const Hit acne = bvh.closest_hit(shown, out);
      ASSERT_FALSE(acne.found()) << test::describe(out, acne);
      const Ray in{offset_origin(point, -outwards), -outwards};
      const Hit far_side = bvh.closest_hit(shown, in);
      ASSERT_TRUE(far_side.found()) << test::describe(in, far_side);
      if (!is_ball) {
        ASSERT_NE(far_side.primitive, hit.primitive);
      }
    }
  }
};

TEST_P(SpawnedRaysOfInstances, OnAMesh) {
  expect_no_acne_and_no_leaks(test::icosphere(2, {}, 1).primitives());
}

TEST_P(SpawnedRaysOfInstances, OnABall) {
  Primitives ball;
  ball.add_sphere({}, 1, 0);
  expect_no_acne_and_no_leaks(std::move(ball));
}

INSTANTIATE_TEST_SUITE_P(ScalesAndDistances, SpawnedRaysOfInstances,
                         testing::Combine(testing::Values(Vec3{1, 1, 1}, Vec3{-2, 2, 2},
                                                          Vec3{1e-5f, 1e-5f, 1e-5f}, Vec3{1e6f, 1e6f, 1e6f},
                                                          Vec3{3, -0.2f, 1}, Vec3{6, 1, 0.5f}),
                                          testing::Values(0.0f, 10.0f, 1000.0f)));

// At edges and corners of a closed mesh, from inside and from far outside.
TEST(Instance, OfAClosedMeshLeaksNoRays) {
  test::Random random(4);
  const test::Mesh mesh = test::icosphere(3, {5, 0, 0}, 1);
  for (int t = 0; t < 20; ++t) {
    const Transform transform = test::random_transform(random, 500);
    Primitives shown;
    shown.add_object(mesh.primitives());
    shown.add_instance({Placement(transform), 0});
    const accel::Bvh bvh = accel::Bvh::build(shown, 1);
    for (int i = 0; i < 5000; ++i) {
      const Vec3 inside = transform.point(Vec3{5, 0, 0} + random.in_box(0.4f));
      const Vec3 target = test::point_of(shown, random);
      ASSERT_TRUE(bvh.any_hit(shown, {inside, target - inside})) << t << ' ' << i;
      const Vec3 through = transform.point({5, 0, 0}) - target;
      const Vec3 outside = target - 50 * through;
      ASSERT_TRUE(bvh.any_hit(shown, {outside, through})) << t << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace tessera::core
