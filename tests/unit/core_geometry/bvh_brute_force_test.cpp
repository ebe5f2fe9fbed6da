// SPDX-License-Identifier: Apache-2.0
// A Bvh returns, bit for bit, what asking every primitive returns.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "tests/support/effort.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void expect_same_hits(const accel::Bvh& bvh, const Primitives& primitives, Ray ray) {
  const Hit expected = test::brute_force_hit(primitives, ray), actual = bvh.closest_hit(primitives, ray);
  ASSERT_TRUE(test::identical(expected, actual))
      << "expected " << test::describe(ray, expected) << "\n     got " << test::describe(ray, actual);
  ASSERT_EQ(bvh.any_hit(primitives, ray), expected.found()) << test::describe(ray, expected);
  if (!expected.found()) return;
  ASSERT_TRUE(expected.t > 0 && expected.t < ray.t_max);

  // t_max is exclusive, to the last bit.
  ray.t_max = expected.t;
  ASSERT_FALSE(bvh.any_hit(primitives, ray)) << test::describe(ray, expected);
  ray.t_max = std::nextafter(expected.t, kInfinity);
  ASSERT_TRUE(bvh.any_hit(primitives, ray)) << test::describe(ray, expected);
  ASSERT_TRUE(test::identical(bvh.closest_hit(primitives, ray), expected));
}

class BruteForce : public testing::TestWithParam<std::uint32_t> {};

TEST_P(BruteForce, FindsTheSameHitsInEverySoup) {
  const std::uint32_t count = GetParam();
  const int rays = static_cast<int>(std::min(10000u, 2000000 / count) / tessera::test::kEffortDivisor);
  for (const test::Soup& soup : test::all_soups(count)) {
    SCOPED_TRACE(soup.name);
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 2);
    test::Random random(9);
    int hits = 0;
    for (int i = 0; i < rays; ++i) {
      const Ray ray = test::random_ray(soup, random);
      expect_same_hits(bvh, soup.primitives, ray);
      if (HasFatalFailure()) return;
      hits += bvh.any_hit(soup.primitives, ray) ? 1 : 0;
    }
    if (count >= 33) {
      EXPECT_GT(hits, rays / 50) << "too few hits to mean anything";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, BruteForce, testing::Values(1, 2, 5, 33, 400, 5000));

void expect_same_hits_on(const test::Mesh& mesh) {
  const Primitives primitives = mesh.primitives();
  ASSERT_GT(primitives.count(), 50000u);
  const accel::Bvh bvh = accel::Bvh::build(primitives, 2);
  Aabb box;
  for (const Vec3& p : mesh.positions) box.include(p);
  const float size = length(box.upper - box.lower);
  test::Random random(10);
  for (int i = 0; i < 100; ++i) {
    const Vec3 origin = 0.5f * (box.lower + box.upper) + size * random.direction();
    expect_same_hits(bvh, primitives, {origin, test::point_of(primitives, random) - origin});
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(BruteForce, FindsTheSameHitsOnABumpyBody) {
  test::Mesh mesh = test::icosphere(6, {0, 0, 0}, 1);
  for (Vec3& p : mesh.positions)
    p = (1 + 0.2f * std::sin(9 * p.x) * std::sin(7 * p.y) * std::sin(8 * p.z)) * p;
  expect_same_hits_on(mesh);
}

TEST(BruteForce, FindsTheSameHitsOnTheBunny) {
  std::ifstream file(TESSERA_SOURCE_DIR "/../shared/data/bunny.obj");
  if (!file) GTEST_SKIP() << "shared/data/bunny.obj is not here";
  test::Mesh mesh;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3& p = mesh.positions.emplace_back();
      words >> p.x >> p.y >> p.z;
    } else if (kind == "f") {
      auto& triangle = mesh.triangles.emplace_back();
      for (std::uint32_t& v : triangle) {
        std::string reference;
        words >> reference;
        v = static_cast<std::uint32_t>(std::stoul(reference)) - 1;
      }
    }
  }
  expect_same_hits_on(mesh);
}

TEST(Bvh, OfNothingIsMissed) {
  const Primitives nothing;
  EXPECT_FALSE(accel::Bvh().closest_hit(nothing, {{0, 0, 0}, {0, 0, 1}}).found());
  EXPECT_FALSE(accel::Bvh::build(nothing, 2).any_hit(nothing, {{0, 0, 0}, {0, 0, 1}}));
}

TEST(Bvh, SurvivesRaysThatAreNotRays) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const test::Soup& soup : test::all_soups(100)) {
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
    for (const float bad : {nan, kInfinity, -kInfinity, 0.0f}) {
      EXPECT_FALSE(bvh.any_hit(soup.primitives, {{0, 0, 0}, {bad, bad, bad}}));
      const Hit hit = bvh.closest_hit(soup.primitives, {{bad, 0, 0}, {0, bad, 1}});
      EXPECT_TRUE(!hit.found() || (bad == 0 && std::isfinite(hit.t)));
    }
  }
}

TEST(Bvh, LeavesOutWhatIsNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  test::Mesh mesh;
  mesh.add({Vec3{-1, -1, 2}, Vec3{1, -1, 2}, Vec3{0, 1, 2}});
  mesh.add({Vec3{-1, -1, 1}, Vec3{1, -1, 1}, Vec3{0, nan, 1}});
  mesh.add({Vec3{-1, -1, 1}, Vec3{1, -1, 1}, Vec3{0, kInfinity, 1}});
  Primitives primitives = mesh.primitives();
  primitives.add_sphere({0, 0, 1}, kInfinity, 0);
  primitives.add_sphere({0, nan, 1}, 1, 0);
  const Hit hit = accel::Bvh::build(primitives, 1).closest_hit(primitives, {{0, 0, 0}, {0, 0, 1}});
  EXPECT_EQ(hit.primitive, 0u);
  EXPECT_EQ(hit.t, 2);
}

}  // namespace
}  // namespace tessera::core
