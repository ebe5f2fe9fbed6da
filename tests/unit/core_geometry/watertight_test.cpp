// SPDX-License-Identifier: Apache-2.0
// No ray passes between the triangles of a closed mesh, even if it is aimed exactly at an edge or a corner.
#include <gtest/gtest.h>

#include "tests/unit/core_geometry/batches.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

struct Place {
  float radius;
  Vec3 center;
};

class Watertight : public testing::TestWithParam<Place> {};

// A ray from inside a sphere's mesh at an edge's middle or a corner.
Ray ray_at_seam(const test::Mesh& mesh, Vec3 origin, test::Random& random) {
  const auto& [a, b, c] = mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
  const Vec3 w = random.below(2) == 0 ? Vec3{1, 0, 0} : Vec3{0.5f, 0.5f, 0};
  const Vec3 target = w.x * mesh.positions[a] + w.y * mesh.positions[b] + w.z * mesh.positions[c];
  return {origin, target - origin};
}

TEST_P(Watertight, RaysFromInsideNeverLeaveAClosedMesh) {
  const auto [radius, center] = GetParam();
  const test::Mesh mesh = test::icosphere(4, center, radius);
  const Primitives primitives = mesh.primitives();
  const accel::Bvh bvh = accel::Bvh::build(primitives, 1);
  test::Random random(8);
  for (int i = 0; i < 250000; ++i) {
    const Ray ray = ray_at_seam(mesh, i % 4 == 0 ? center : center + random.in_box(0.5f * radius), random);
    const Hit hit = bvh.closest_hit(primitives, ray);
    ASSERT_TRUE(hit.found()) << test::describe(ray, hit);
    ASSERT_NEAR(hit.t, 1, 1e-2f);
  }
}

TEST_P(Watertight, NorDoManyRaysAtOnce) {
  const auto [radius, center] = GetParam();
  const test::Mesh mesh = test::icosphere(4, center, radius);
  const Primitives primitives = mesh.primitives();
  const accel::Bvh bvh = accel::Bvh::build(primitives, 1);
  test::Random random(8);
  std::vector<Ray> rays(4096);
  for (int batch = 0; batch < 64; ++batch) {
    const Vec3 origin = center + random.in_box(0.5f * radius);
    for (Ray& ray : rays)
      ray = ray_at_seam(mesh, batch % 2 == 0 ? origin : center + random.in_box(0.5f * radius), random);
    const std::vector<Hit> hits = test::closest_hits(bvh, primitives, rays);
    const std::vector<accel::Occlusion> occluded = test::occlusions(bvh, primitives, rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_TRUE(hits[i].found() && occluded[i] == accel::Occlusion::kFull)
          << test::describe(rays[i], hits[i]);
  }
}

INSTANTIATE_TEST_SUITE_P(Places, Watertight,
                         testing::Values(Place{1, {0, 0, 0}}, Place{1e-3f, {0, 0, 0}}, Place{1e5f, {0, 0, 0}},
                                         Place{1, {100, -200, 300}}));

TEST(Watertight, AxisAlignedRaysNeverPassBetweenTheCellsOfAGrid) {
  constexpr std::uint32_t kCells = 16;
  test::Mesh grid;
  for (std::uint32_t y = 0; y < kCells; ++y) {
    for (std::uint32_t x = 0; x < kCells; ++x) {
      const auto corner = [&](std::uint32_t dx, std::uint32_t dy) {
        return Vec3{static_cast<float>(x + dx) * 0.1f, static_cast<float>(y + dy) * 0.1f, 0};
      };
      grid.add({corner(0, 0), corner(1, 0), corner(1, 1)});
      grid.add({corner(0, 0), corner(1, 1), corner(0, 1)});
    }
  }
  const Primitives primitives = grid.primitives();
  const accel::Bvh bvh = accel::Bvh::build(primitives, 1);
  for (std::uint32_t y = 0; y <= 2 * kCells; ++y) {
    for (std::uint32_t x = 0; x <= 2 * kCells; ++x) {
      const Vec3 origin{static_cast<float>(x) * 0.5f * 0.1f, static_cast<float>(y) * 0.5f * 0.1f, 1};
      EXPECT_TRUE(bvh.any_hit(primitives, {origin, {0, 0, -1}})) << x << " " << y;
      EXPECT_TRUE(bvh.any_hit(primitives, {origin, {-0.0f, -0.0f, -3}})) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace tessera::core
