// SPDX-License-Identifier: Apache-2.0
// The tree itself: the same for any number of threads, complete, and of bounded depth whatever it is made of.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "core/accel/binary_bvh.hpp"
#include "tests/support/effort.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

TEST(BvhStructure, IsTheSameForAnyNumberOfThreads) {
  for (const test::Soup& soup : test::all_soups(10000)) {
    const accel::Bvh one = accel::Bvh::build(soup.primitives, 1);
    for (const int threads : {2, 3})
      EXPECT_TRUE(accel::Bvh::build(soup.primitives, threads) == one) << soup.name;
  }
  // Large enough for many threads to work on the same cut.
  for (const test::Soup& soup : test::all_soups(70000)) {
    if (tessera::test::kEffortDivisor > 1 && soup.name != std::string("uniform")) continue;
    const accel::Bvh one = accel::Bvh::build(soup.primitives, 1);
    EXPECT_TRUE(accel::Bvh::build(soup.primitives, 4) == one) << soup.name;
  }
  const auto soups = test::all_soups(1000);
  EXPECT_FALSE(accel::Bvh::build(soups[0].primitives, 1) == accel::Bvh::build(soups[1].primitives, 1));
}

bool contains(const Aabb& outer, const Aabb& inner) {
  Aabb both = outer;
  both.include(inner);
  return both == outer;
}

// Checks the subtree, appends its primitives and returns its depth.
int check(const Primitives& primitives, const accel::BinaryBvh& tree, std::uint32_t index,
          std::vector<std::uint32_t>& found) {
  const accel::BinaryBvh::Node& node = tree.nodes[index];
  if (node.is_leaf()) {
    EXPECT_LE(node.count, accel::kMaxLeafSize);
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      found.push_back(tree.order[i]);
      EXPECT_TRUE(contains(node.box(), primitives.bounds(tree.order[i])));
    }
    return 0;
  }
  EXPECT_TRUE(contains(node.box(), tree.nodes[node.left()].box()));
  EXPECT_TRUE(contains(node.box(), tree.nodes[node.right()].box()));
  return 1 +
         std::max(check(primitives, tree, node.left(), found), check(primitives, tree, node.right(), found));
}

int check(const Primitives& primitives) {
  const accel::BinaryBvh tree = accel::build_binary_bvh(primitives, 2);
  std::vector<std::uint32_t> found, expected;
  const int depth = check(primitives, tree, 0, found);
  for (std::uint32_t i = 0; i < primitives.count(); ++i) {
    if (!primitives.bounds(i).empty()) expected.push_back(i);
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
  return depth;
}

TEST(BvhStructure, HoldsEverythingOnceWithinItsBoxes) {
  for (const test::Soup& soup : test::all_soups(5000)) {
    SCOPED_TRACE(soup.name);
    EXPECT_LE(check(soup.primitives), accel::kMaxTreeDepth);
  }
}

// Triangles, spheres, disks and instances of a ball, close to each other.
Primitives of_many_kinds() {
  test::Mesh mesh;
  for (int i = 0; i < 100; ++i) {
    const float x = static_cast<float>(i % 10), y = static_cast<float>(i / 10);
    mesh.add({Vec3{x, y, 0}, Vec3{x + 1, y, 0}, Vec3{x, y + 1, 0}});
  }
  Primitives primitives = mesh.primitives();
  const auto at = [](int i) { return Vec3{static_cast<float>(i % 10), static_cast<float>(i / 10), 0.1f}; };
  for (int i = 0; i < 100; i += 3) primitives.add_sphere(at(i), 0.2f, 0);
  for (int i = 0; i < 100; i += 7) primitives.add_disk(Disk{at(i), {1, 0, 0}, {0, 1, 0}, 0}, 0);
  Primitives ball;
  ball.add_sphere({0, 0, 0}, 0.5f, 0);
  primitives.add_object(std::move(ball));
  for (int i = 0; i < 100; i += 11) primitives.add_instance({Placement(translation(at(i))), 0});
  return primitives;
}

TEST(BvhStructure, HasOneKindInEachLeafAndEachInstanceAlone) {
  const Primitives primitives = of_many_kinds();
  check(primitives);
  const accel::Bvh bvh = accel::Bvh::build(primitives, 2);
  std::set<GeometryKind> kinds;
  std::size_t found = 0;
  for (const accel::BvhPacket& packet : bvh.arrays().packets) {
    kinds.insert(packet.kind);
    EXPECT_TRUE(packet.kind != GeometryKind::kInstance || packet.lanes == 1);
    accel::for_each_lane(packet.lanes, [&](std::size_t lane) {
      EXPECT_EQ(primitives.kind(packet.primitives[lane]), packet.kind);
      ++found;
    });
  }
  EXPECT_EQ(found, primitives.count());
  EXPECT_EQ(kinds.size(), 4u);
}

TEST(BvhStructure, OfIdenticalTrianglesIsBalanced) {
  test::Mesh mesh;
  for (int i = 0; i < 100000; ++i) mesh.add({Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{0, 1, 0}});
  const Primitives primitives = mesh.primitives();
  EXPECT_LE(check(primitives), 15);
  const Hit hit = accel::Bvh::build(primitives, 2).closest_hit(primitives, {{0, 0, 1}, {0, 0, -1}});
  EXPECT_EQ(hit.primitive, 0u) << "of all that are as near, the lowest id";
}

TEST(BvhStructure, OfExponentiallySpacedTrianglesIsBoundedInDepth) {
  test::Mesh mesh;
  for (int i = 0; i < 100000; ++i) {
    const float x = std::ldexp(1 + static_cast<float>(i / 270) / 1024, i % 270 - 140);
    mesh.add({Vec3{x, -x, 0}, Vec3{x, x, 0}, Vec3{x, 0, x}});
  }
  const Primitives primitives = mesh.primitives();
  const int depth = check(primitives);
  EXPECT_GT(depth, accel::kMaxSahDepth) << "not hard enough to reach the limit";
  EXPECT_LE(depth, accel::kMaxTreeDepth);
  const accel::Bvh bvh = accel::Bvh::build(primitives, 2);
  for (const Ray& ray : {Ray{{-1, 0, 0}, {1, 0, 0}}, Ray{{1e38f, 1e-3f, 1e-3f}, {-1, 0, 0}}}) {
    EXPECT_TRUE(test::identical(bvh.closest_hit(primitives, ray), test::brute_force_hit(primitives, ray)));
  }
}

}  // namespace
}  // namespace tessera::core
