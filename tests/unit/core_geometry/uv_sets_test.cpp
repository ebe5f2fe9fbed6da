// SPDX-License-Identifier: Apache-2.0
// Second texture coordinates of meshes: where a ray finds which, alone and in lanes.
#include <gtest/gtest.h>

#include <array>

#include "core/geometry/surface_points.hpp"
#include "tests/unit/core_geometry/batches.hpp"

namespace tessera::core {
namespace {

const std::vector<Vec2> kFirst{{0, 0}, {1, 0}, {0, 1}}, kSecond{{3, 1}, {5, 1}, {3, 7}};

// A right triangle in the plane z, with one or both sets.
void add_triangle(Primitives& primitives, float z, const std::vector<Vec2>& uvs,
                  const std::vector<Vec2>& second_uvs) {
  primitives.add_mesh({{0, 0, z}, {1, 0, z}, {0, 1, z}}, {}, uvs, {{0, 1, 2}}, {0}, {}, second_uvs);
}

// Triangles without any set, with the first, with both and with the first again; a sphere; an instance of a
// triangle with both, and of one with the first.
Primitives mixed() {
  Primitives primitives;
  add_triangle(primitives, 0, {}, {});
  add_triangle(primitives, 1, kFirst, {});
  add_triangle(primitives, 2, kFirst, kSecond);
  add_triangle(primitives, 3, kSecond, {});
  primitives.add_sphere({0.3f, 0.3f, 5}, 0.5f, 0);
  for (const auto& second_uvs : {kSecond, std::vector<Vec2>()}) {
    Primitives object;
    add_triangle(object, 0, kFirst, second_uvs);
    const std::uint32_t number = primitives.add_object(std::move(object));
    primitives.add_instance(
        {Placement(Transform{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 7 + static_cast<float>(number)}}),
         number});
  }
  return primitives;
}

// What rays against z meet: the nearest of all, or the next ones behind it.
struct Met {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
};
Met all_hits(const Primitives& primitives) {
  const accel::Bvh bvh = accel::Bvh::build(primitives, 1);
  Met met;
  for (const Vec2 at : {Vec2{0.25f, 0.5f}, Vec2{0.1f, 0.3f}, Vec2{0.6f, 0.2f}})
    for (const float z : {0.5f, 1.5f, 2.5f, 3.5f, 5.6f, 7.5f, 8.5f}) {
      const Ray ray{{at.x, at.y, z}, {0, 0, -1}};
      const Hit hit = bvh.closest_hit(primitives, ray);
      EXPECT_TRUE(hit.found());
      met.rays.push_back(ray);
      met.hits.push_back(hit);
    }
  return met;
}

TEST(UvSets, OfAMeshWithTwoDiffer) {
  const Primitives primitives = mixed();
  ASSERT_TRUE(primitives.has_second_uvs());
  for (const Hit& hit :
       {Hit{1, 2, 0.25f, 0.5f}, Hit{.t = 1, .primitive = 0, .b1 = 0.25f, .b2 = 0.5f, .instance = 0}}) {
    const UvSets uv = primitives.uv_sets(hit, {0.25f, 0.5f});
    EXPECT_EQ(uv.first, (Vec2{0.25f, 0.5f}));
    EXPECT_EQ(uv.second, (Vec2{3.5f, 4}));
  }
}

TEST(UvSets, OfOtherShapesAreTheSameTwice) {
  const Primitives primitives = mixed();
  const Met met = all_hits(primitives);
  int same = 0;
  for (std::size_t i = 0; i < met.hits.size(); ++i) {
    const SurfacePoint point = primitives.surface(met.rays[i], met.hits[i]);
    const UvSets uv = primitives.uv_sets(met.hits[i], point.uv);
    EXPECT_EQ(uv.first, point.uv);
    same += uv.second == point.uv ? 1 : 0;
  }
  // All but the triangles with both sets.
  EXPECT_EQ(same, 3 * 5);
}

TEST(UvSets, InLanesAreThoseOfEachHit) {
  const Primitives primitives = mixed();
  const Met met = all_hits(primitives);
  const Columns<Ray> rays{std::span<const Ray>(met.rays)};
  const Columns<Hit> all_hits{std::span<const Hit>(met.hits)};
  for (std::size_t first = 0; first + kLaneCount <= met.hits.size(); ++first) {
    const WordLanes rows = test::rows_from(first);
    const HitRows hits{all_hits.all(), rows};
    const SurfacePointOf<FloatN> points = primitives.surfaces({rays.all(), rows}, hits);
    const UvSetsOf<FloatN> all = primitives.uv_sets(hits, points.uv);
    const FloatLanes u(all.second.x), v(all.second.y);
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const SurfacePoint one = primitives.surface(met.rays[first + lane], met.hits[first + lane]);
      const UvSets uv = primitives.uv_sets(met.hits[first + lane], one.uv);
      EXPECT_EQ((Vec2{u[lane], v[lane]}), uv.second);
    }
  }
}

TEST(UvSets, HaveTangentsOfTheirOwn) {
  Primitives primitives;
  add_triangle(primitives, 0, kFirst, {{0, 0}, {0, 2}, {1, 0}});  // u grows along y, v along x
  const Hit hit{1, 0, 0.25f, 0.5f};
  const SurfacePoint point = primitives.surface({}, hit);
  EXPECT_EQ(primitives.tangents(hit, point).along_u, (Vec3{1, 0, 0}));
  const Tangents second = primitives.tangents(hit, point, UvSet::kSecond);
  EXPECT_EQ(second.along_u, (Vec3{0, 1, 0}));
  EXPECT_EQ(second.along_v, (Vec3{1, 0, 0}));
  EXPECT_EQ(primitives.uv_derivatives(hit, point, UvSet::kSecond).dp_dv, (Vec3{0.5f, 0, 0}));
}

// Where the mesh is as it deforms does not matter.
TEST(UvSets, StayWhileAMeshDeforms) {
  Primitives primitives;
  add_triangle(primitives, 0, kFirst, kSecond);
  primitives.deform_last_mesh(
      {{0, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}}, {1, {{0, 0, 2}, {1, 0, 2}, {0, 1, 3}}, {}}}, 0);
  primitives.deform(0, {0, 1});
  Hit hit{1, 0, 0.25f, 0.5f};
  hit.time = 0.5f;
  EXPECT_EQ(primitives.uv_sets(hit, {0.25f, 0.5f}).second, (Vec2{3.5f, 4}));
}

TEST(UvSets, TakeNoMemoryWhereNoMeshHasTwo) {
  Primitives primitives;
  add_triangle(primitives, 0, kFirst, {});
  EXPECT_FALSE(primitives.has_second_uvs());
}

}  // namespace
}  // namespace tessera::core
