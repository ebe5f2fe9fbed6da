// SPDX-License-Identifier: Apache-2.0
// Tangents that meshes give their vertices: which frames they make, in instances and while meshes deform.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "core/geometry/primitives.hpp"
#include "tests/support/near.hpp"

namespace tessera::core {
namespace {

// In the plane z = 0, seen from +z, with u along x and v along y.
void add_triangle(Primitives& primitives, const std::vector<VertexTangent>& tangents) {
  primitives.add_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}, {0}, {},
                      {}, tangents);
}
std::vector<VertexTangent> all(const VertexTangent& tangent) {
  return {tangent, tangent, tangent};
}

const Hit kHit{.t = 1, .primitive = 0, .b1 = 0.25f, .b2 = 0.5f};

Tangents tangents_at(const Primitives& primitives, const Hit& hit) {
  return primitives.tangents(hit, primitives.surface({}, hit));
}

TEST(VertexTangents, AreInterpolatedAndMakeTheBitangent) {
  Primitives primitives;
  add_triangle(primitives, {{{2, 0, 0}, 1}, {{0, 3, 0}, 1}, {{0, 0.5f, 0}, 1}});
  const Tangents along = tangents_at(primitives, kHit);
  const Vec3 expected = normalize(Vec3{0.25f, 0.75f, 0});
  expect_near(along.along_u, expected, 1e-6f);
  expect_near(along.along_v, {-expected.y, expected.x, 0}, 1e-6f);
}

TEST(VertexTangents, OfTheOtherHandednessTurnTheBitangentOver) {
  Primitives primitives;
  add_triangle(primitives, all({{0, 1, 0}, -1}));
  const Tangents along = tangents_at(primitives, kHit);
  EXPECT_EQ(along.along_u, (Vec3{0, 1, 0}));
  EXPECT_EQ(along.along_v, (Vec3{1, 0, 0}));
}

TEST(VertexTangents, ReplaceThoseOfAllTextureCoordinates) {
  Primitives primitives;
  add_triangle(primitives, all({{0, 1, 0}, 1}));
  const SurfacePoint point = primitives.surface({}, kHit);
  for (const UvSet set : {UvSet::kFirst, UvSet::kSecond})
    EXPECT_EQ(primitives.tangents(kHit, point, set).along_u, (Vec3{0, 1, 0}));
  EXPECT_EQ(primitives.uv_derivatives(kHit, point).dp_du, (Vec3{1, 0, 0}));
}

// Vertices without one, other meshes and other shapes have those of their texture coordinates.
TEST(VertexTangents, AreThoseOfTextureCoordinatesWhereThereAreNone) {
  Primitives primitives;
  add_triangle(primitives, {});
  add_triangle(primitives, all({{0, 1, 0}, 1}));
  add_triangle(primitives, all({{0, 0, 0}, 1}));
  add_triangle(primitives, {});
  primitives.add_sphere({0, 0, 0}, 1, 0);
  for (const std::uint32_t triangle : {0u, 2u, 3u}) {
    Hit hit = kHit;
    hit.primitive = triangle;
    EXPECT_FALSE(primitives.vertex_tangents(hit, primitives.surface({}, hit)));
    EXPECT_EQ(tangents_at(primitives, hit).along_u, (Vec3{1, 0, 0})) << triangle;
  }
  const Hit sphere{.t = 1, .primitive = 4, .b1 = 0, .b2 = 0};
  EXPECT_FALSE(primitives.vertex_tangents(sphere, primitives.surface({{0, 0, 2}, {0, 0, -1}}, sphere)));
}

// Under a reflection, the bitangent is the image of that of the object.
TEST(VertexTangents, OfInstancesAreTransformed) {
  for (const float mirror : {1.0f, -1.0f}) {
    Primitives object, primitives;
    add_triangle(object, all({{0.6f, 0.8f, 0}, 1}));
    const std::uint32_t number = primitives.add_object(std::move(object));
    const Transform turned{{0, 2 * mirror, 0}, {-2, 0, 0}, {0, 0, 2}, {0, 0, 5}};
    primitives.add_instance({Placement(turned), number});
    Hit hit = kHit;
    hit.instance = 0;
    const Tangents along = tangents_at(primitives, hit);
    expect_near(along.along_u, {-0.8f, mirror * 0.6f, 0}, 1e-6f);
    expect_near(along.along_v, {-0.6f, mirror * -0.8f, 0}, 1e-6f);
  }
}

TEST(VertexTangents, TurnWhileAMeshDeforms) {
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<MeshStep> steps{{0, corners, {}, all({{1, 0, 0}, -1})},
                                    {1, corners, {}, all({{0, 3, 0}, -1})}};
  Primitives primitives;
  add_triangle(primitives, steps[0].tangents);
  primitives.deform_last_mesh(steps, 0);
  const Vec3 half = normalize(Vec3{1, 1, 0});
  primitives.deform(0, {0, 1});
  Hit hit = kHit;
  hit.time = 0.5f;
  expect_near(tangents_at(primitives, hit).along_u, half, 1e-6f);
  expect_near(tangents_at(primitives, hit).along_v, {half.y, -half.x, 0}, 1e-6f);
  primitives.deform(0.5f, {});
  expect_near(tangents_at(primitives, kHit).along_u, half, 1e-6f);
}

}  // namespace
}  // namespace tessera::core
