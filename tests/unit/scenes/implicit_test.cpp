// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/math/elementary.hpp"
#include "scenes/modelling/atlas.hpp"
#include "scenes/modelling/marching_cubes.hpp"
#include "scenes/modelling/noise.hpp"
#include "tests/unit/scenes/mesh_properties.hpp"

namespace tessera::modelling {
namespace {

using core::MeshDescription;
using core::Rgb;
using core::Vec2;

const CubeLattice kAroundUnitBall{{-1.3f, -1.3f, -1.3f}, {1.3f, 1.3f, 1.3f}, 0.1f};

// Vertices - edges + faces: 2 for what a ball can be kneaded into, 0 for a ring.
long euler_characteristic(const MeshDescription& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) edges.insert(std::minmax(t[i], t[(i + 1) % 3]));
  }
  return static_cast<long>(mesh.positions.size()) - static_cast<long>(edges.size()) +
         static_cast<long>(mesh.triangles.size());
}

Field ring() {
  return [](Vec3 p) {
    const float from_axis = std::sqrt(p.x * p.x + p.z * p.z) - 0.8f;
    return std::sqrt(from_axis * from_axis + p.y * p.y) - 0.25f;
  };
}

TEST(SmoothUnion, IsTheUnionFarFromTheSeamAndFillsIt) {
  const Field a = ball({-1, 0, 0}, 1), b = ball({1, 0, 0}, 1), both = unite(a, b, 0.4f);
  EXPECT_FLOAT_EQ(both({-2.5f, 0, 0}), 0.5f);
  EXPECT_FLOAT_EQ(both({0, 0, 0}), -0.1f);
  EXPECT_GT(unite(a, b, 0)({0, 0.1f, 0}), 0);
  EXPECT_LT(both({0, 0.1f, 0}), 0);
}

TEST(Carve, TakesTheToolAway) {
  const Field left = carve(ball({0, 0, 0}, 1), ball({1, 0, 0}, 0.5f), 0);
  EXPECT_FLOAT_EQ(left({0.9f, 0, 0}), 0.4f);
  EXPECT_FLOAT_EQ(left({-0.5f, 0, 0}), -0.5f);
}

TEST(Ellipsoid, HasItsRadiiAlongItsAxes) {
  const Field field = ellipsoid({{1, 2, 3}, {1, 2, 3}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_NEAR(field(Vec3{1, 2, 3} + Vec3{2, 0, 0}), 0, 1e-6);  // up is x
  EXPECT_NEAR(field(Vec3{1, 2, 3} + Vec3{0, 3, 0}), 0, 1e-6);  // forward is y
  EXPECT_NEAR(field(Vec3{1, 2, 3} - Vec3{0, 0, 1}), 0, 1e-6);
  EXPECT_FLOAT_EQ(field({1, 2, 3}), -1);
}

TEST(Limb, HasItsRadiiAtItsEnds) {
  const Field field = limb({0, 0, 0}, 1, {0, 4, 0}, 0.5f);
  EXPECT_FLOAT_EQ(field({0, -1, 0}), 0);
  EXPECT_FLOAT_EQ(field({0, 4.5f, 0}), 0);
  EXPECT_FLOAT_EQ(field({0.75f, 2, 0}), 0);
}

TEST(BothSides, IsSymmetric) {
  const Field field = both_sides(ball({1, 0, 0}, 0.6f), 0.2f);
  EXPECT_EQ(field({0.7f, 0.3f, 0.1f}), field({-0.7f, 0.3f, 0.1f}));
}

TEST(MarchingCubes, BallIsClosedAndHasItsVolume) {
  const MeshDescription mesh = marching_cubes(ball({0.013f, 0, 0}, 1), kAroundUnitBall);
  EXPECT_EQ(open_edge_count(mesh), 0);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_NEAR(enclosed_volume(mesh), 4.0 / 3 * core::kPi, 0.03);
}

TEST(MarchingCubes, ErrorOfTheVolumeFallsWithTheSquareOfTheCubes) {
  const auto error = [](float size) {
    CubeLattice lattice = kAroundUnitBall;
    lattice.size = size;
    return 4.0 / 3 * core::kPi - enclosed_volume(marching_cubes(ball({0.013f, 0.007f, 0.003f}, 1), lattice));
  };
  EXPECT_NEAR(error(0.16f) / error(0.08f), 4, 0.4);
}

TEST(MarchingCubes, NormalsOfABallAreItsRadii) {
  const MeshDescription mesh = marching_cubes(ball({0, 0, 0}, 1), kAroundUnitBall);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(length(mesh.normals[i] - normalize(mesh.positions[i])), 0, 0.01) << "vertex " << i;
  }
}

TEST(MarchingCubes, RingHasAHole) {
  const MeshDescription mesh = marching_cubes(ring(), kAroundUnitBall);
  EXPECT_EQ(open_edge_count(mesh), 0);
  EXPECT_EQ(euler_characteristic(mesh), 0);
}

// Independent signs at all corners show every one of the 256 cubes, beside every other.
TEST(MarchingCubes, IsClosedForAnyField) {
  for (int seed = 0; seed < 4; ++seed) {
    const Field random = [seed](Vec3 p) {
      const auto at = [](float v) { return static_cast<std::int32_t>(std::floor(v + 0.5f)); };
      return random_at(at(p.x) + 1000 * seed, at(p.y), at(p.z)) - 0.5f;
    };
    const MeshDescription mesh = marching_cubes(random, {{0, 0, 0}, {14, 14, 14}, 1});
    EXPECT_GT(mesh.triangles.size(), 5000u);
    EXPECT_EQ(open_edge_count(mesh), 0) << "seed " << seed;
    EXPECT_GT(enclosed_volume(mesh), 0);
  }
}

TEST(MarchingCubes, WhatLeavesTheLatticeIsCutOff) {
  const MeshDescription mesh = marching_cubes(ball({0, 0, 0}, 2), kAroundUnitBall);
  EXPECT_EQ(open_edge_count(mesh), 0);
  for (const Vec3 p : mesh.positions)
    EXPECT_LT(std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}), 1.4f);
}

TEST(MarchingCubes, IsTheSameEveryTime) {
  const MeshDescription a = marching_cubes(ring(), kAroundUnitBall),
                        b = marching_cubes(ring(), kAroundUnitBall);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.triangles, b.triangles);
}

constexpr int kTexturePx = 256;

TEST(Unwrap, KeepsTheSurfaceAndStaysInTheUnitSquare) {
  const MeshDescription ball_mesh = marching_cubes(ball({0, 0, 0}, 1), kAroundUnitBall);
  const MeshDescription unwrapped = unwrap(ball_mesh, kTexturePx);
  EXPECT_EQ(unwrapped.triangles.size(), ball_mesh.triangles.size());
  EXPECT_EQ(open_edge_count(unwrapped), 0);
  EXPECT_NEAR(enclosed_volume(unwrapped), enclosed_volume(ball_mesh), 1e-4);
  ASSERT_EQ(unwrapped.uvs.size(), unwrapped.positions.size());
  for (const Vec2 uv : unwrapped.uvs) EXPECT_TRUE(uv.x > 0 && uv.x < 1 && uv.y > 0 && uv.y < 1);
}

// No texel's centre lies in two triangles, and none is mirrored.
void expect_no_overlap(const MeshDescription& mesh) {
  std::set<std::pair<int, int>> covered;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec2 p = mesh.uvs[a] * kTexturePx, q = mesh.uvs[b] * kTexturePx, r = mesh.uvs[c] * kTexturePx;
    const auto side = [](Vec2 from, Vec2 to, Vec2 x) {
      return (to.x - from.x) * (x.y - from.y) - (to.y - from.y) * (x.x - from.x);
    };
    EXPECT_GE(side(p, q, r), -1e-3f);
    for (int y = static_cast<int>(std::min({p.y, q.y, r.y})); y <= std::max({p.y, q.y, r.y}); ++y) {
      for (int x = static_cast<int>(std::min({p.x, q.x, r.x})); x <= std::max({p.x, q.x, r.x}); ++x) {
        const Vec2 center{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
        if (side(p, q, center) <= 0 || side(q, r, center) <= 0 || side(r, p, center) <= 0) continue;
        EXPECT_TRUE(covered.insert({x, y}).second) << "texel " << x << ", " << y;
      }
    }
  }
  EXPECT_GT(covered.size(), kTexturePx * kTexturePx / 5u);
}

TEST(Unwrap, NoTexelShowsTwoPlaces) {
  expect_no_overlap(unwrap(marching_cubes(ball({0, 0, 0}, 1), kAroundUnitBall), kTexturePx));
  expect_no_overlap(unwrap(marching_cubes(ring(), kAroundUnitBall), kTexturePx));
  // A hook: seen from the front, its tip hangs before its stem.
  const Field hook = unite(unite(limb({0, -0.9f, -0.5f}, 0.25f, {0, 0.8f, -0.5f}, 0.25f),
                                 limb({0, 0.8f, -0.5f}, 0.25f, {0, 0.5f, 0.4f}, 0.2f), 0.2f),
                           limb({0, 0.5f, 0.4f}, 0.2f, {0, -0.5f, 0.3f}, 0.15f), 0.2f);
  expect_no_overlap(unwrap(marching_cubes(hook, kAroundUnitBall), kTexturePx));
}

// The texture read at a vertex's uv is the colour of the vertex's place, on both sides of every cut.
TEST(PaintSurface, PutsColorsWhereTheyBelong) {
  const MeshDescription mesh = unwrap(marching_cubes(ring(), kAroundUnitBall), kTexturePx);
  const auto color = [](Vec3 p) { return Rgb{0.5f + 0.3f * p.x, 0.5f + 0.3f * p.y, 0.5f + 0.3f * p.z}; };
  const core::Image image = paint_surface(mesh, kTexturePx, [&](Vec3 p, Vec3) { return color(p); });
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const int x = static_cast<int>(mesh.uvs[i].x * kTexturePx);
    const int y = kTexturePx - 1 - static_cast<int>(mesh.uvs[i].y * kTexturePx);
    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}}) {
      const Rgb painted = image.at(x + dx, y + dy), expected = color(mesh.positions[i]);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(painted[c], expected[c], 0.03f) << "vertex " << i;
    }
  }
}

}  // namespace
}  // namespace tessera::modelling
