// SPDX-License-Identifier: Apache-2.0
// Primitives::surface: where a hit is, how well that is known, and which way the surface faces there.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

// By how much the true surface may lie off `point.position` along `normal`.
double margin(const SurfacePoint& point, Vec3d normal) {
  const Vec3d error(point.position_error);
  return std::fabs(normal.x) * error.x + std::fabs(normal.y) * error.y + std::fabs(normal.z) * error.z;
}

TEST(Surface, OfTrianglesLiesInTheirPlaneWithinTheErrorBound) {
  test::Random random(5);
  for (const float scale : {1e-3f, 1.0f, 1e5f, 1e12f}) {
    for (const float distance : {0.0f, 10.0f, 1000.0f}) {
      for (int i = 0; i < 2000; ++i) {
        const Vec3 center = distance * scale * random.direction();
        test::Mesh mesh;
        mesh.add(
            {center + random.in_box(scale), center + random.in_box(scale), center + random.in_box(scale)});
        const Primitives primitives = mesh.primitives();
        const Vec3 w = random.weights();
        const SurfacePoint point = primitives.surface({}, {1, 0, w.y, w.z});
        const TriangleCorners corners = primitives.triangle_corners(0);
        const Vec3d area = area_normal(corners), normal = (1 / length(area)) * area;
        // In double the distance itself is known to about 1e-15 of the coordinates.
        const double off_plane = std::fabs(dot(normal, Vec3d(point.position) - Vec3d(corners[0])));
        ASSERT_LE(off_plane, margin(point, normal)) << scale << " " << distance;
        ASSERT_LE(length(point.position_error), 1e-6f * (length(center) + 2 * scale))
            << "not needlessly wide";
      }
    }
  }
}

TEST(Surface, OfSpheresLiesOnThemWithinTheErrorBound) {
  test::Random random(6);
  for (const float radius : {1e-3f, 1.0f, 1e5f}) {
    for (const float distance : {0.0f, 10.0f, 1000.0f}) {
      for (int i = 0; i < 2000; ++i) {
        Primitives primitives;
        const Vec3 center = distance * radius * random.direction();
        primitives.add_sphere(center, radius, 0);
        const Vec3 origin = center + random.in_box(100 * radius);
        const Ray ray{origin, center + random.in_box(0.5f * radius) - origin};
        Hit hit;
        ASSERT_TRUE(primitives.intersect(0, ray, hit));
        const SurfacePoint point = primitives.surface(ray, hit);
        const Vec3d from_center = Vec3d(point.position) - Vec3d(center);
        const double off_sphere = std::fabs(length(from_center) - static_cast<double>(radius));
        ASSERT_LE(off_sphere, margin(point, (1 / length(from_center)) * from_center) * 1.001);
        ASSERT_NEAR(length(point.geometric_normal), 1, 1e-6f);
        ASSERT_GT(dot(Vec3d(point.geometric_normal), from_center) / length(from_center), 0.9999);
        ASSERT_EQ(point.shading_normal, point.geometric_normal);
      }
    }
  }
}

const std::vector<Vec3> kCorners{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};

SurfacePoint center_of(const std::vector<Vec3>& normals, const std::vector<Vec2>& uvs) {
  Primitives primitives;
  primitives.add_mesh(kCorners, normals, uvs, {{0, 1, 2}}, {0});
  return primitives.surface({}, {1, 0, 0.25f, 0.5f});
}

TEST(Surface, WithoutNormalsFacesTheCounterClockwiseSide) {
  const SurfacePoint point = center_of({}, {});
  EXPECT_EQ(point.position, (Vec3{0.5f, 1, 0}));
  EXPECT_EQ(point.geometric_normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(point.shading_normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(point.uv, (Vec2{0, 0}));
}

TEST(Surface, InterpolatesNormalsOfAnyLengthAndUvs) {
  const SurfacePoint point = center_of({{0, 0, 3}, {0, 0, 1e-3f}, {0, 1e20f, 0}}, {{0, 0}, {1, 0}, {0, 1}});
  EXPECT_EQ(point.geometric_normal, (Vec3{0, 0, 1}));
  const Vec3 expected = normalize(Vec3{0, 0.5f, 0.5f});
  EXPECT_NEAR(length(point.shading_normal - expected), 0, 1e-6f);
  EXPECT_EQ(point.uv, (Vec2{0.25f, 0.5f}));
}

TEST(Surface, TurnsInterpolatedNormalsToTheSideOfTheWinding) {
  const SurfacePoint point = center_of({{0, 0, -1}, {0, 0, -1}, {1, 0, -1}}, {});
  EXPECT_EQ(point.geometric_normal, (Vec3{0, 0, 1}));
  EXPECT_NEAR(length(point.shading_normal - normalize(Vec3{-1, 0, 1 + std::numbers::sqrt2_v<float>})), 0, 1e-6f);
}

TEST(Surface, FallsBackToTheGeometricNormalWhereNormalsCancelOrAreNone) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const auto& normals : {std::vector<Vec3>{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
                              std::vector<Vec3>{{1, 0, 0}, {1, 0, 0}, {-1, 0, 0}},
                              std::vector<Vec3>{{infinity, 0, 0}, {0, 0, 0}, {0, 0, 0}}}) {
    const SurfacePoint point = center_of(normals, {});
    EXPECT_EQ(point.geometric_normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(point.shading_normal, (Vec3{0, 0, 1}));
  }
}

TEST(Surface, KnowsItsMaterial) {
  Primitives primitives;
  primitives.add_sphere({0, 0, 0}, 1, 7);
  primitives.add_mesh(kCorners, {}, {}, {{0, 1, 2}, {2, 1, 0}}, {4, 5});
  primitives.add_mesh(kCorners, {}, {}, {{0, 1, 2}, {2, 1, 0}}, {6});
  ASSERT_EQ(primitives.count(), 5u);
  for (std::uint32_t i = 0; i < 5; ++i)
    EXPECT_EQ(primitives.material(i), (std::array{4u, 5u, 6u, 6u, 7u})[i]);
  EXPECT_EQ(primitives.triangle_corners(3)[0], kCorners[2]);
  EXPECT_TRUE(primitives.is_sphere(4));
}

}  // namespace
}  // namespace tessera::core
