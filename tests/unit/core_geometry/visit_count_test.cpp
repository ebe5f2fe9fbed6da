// SPDX-License-Identifier: Apache-2.0
// How much of the tree rays visit: numbers that do not depend on the machine, against what they were when the
// builder was last tuned. Whoever makes them smaller stores the new ones here.
#include <gtest/gtest.h>

#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

constexpr int kRays = 20000;
constexpr double kMargin = 1.03;

// Of rays from around a ball of 82 thousand triangles among scattered ones, half of them at it.
accel::VisitCounts visits_of_ball() {
  test::Random random(5);
  test::Mesh mesh = test::icosphere(6, {0, 0, 0}, 1);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 center = random.in_box(4);
    mesh.add({center + random.in_box(0.1f), center + random.in_box(0.1f), center + random.in_box(0.1f)});
  }
  const Primitives primitives = mesh.primitives();
  std::vector<Ray> rays;
  for (int i = 0; i < kRays; ++i) {
    const Vec3 origin = random.in_box(4);
    rays.push_back({origin, i % 2 == 0 ? random.direction() : random.in_box(1) - origin});
  }
  return accel::Bvh::build(primitives, 2).count_visits(primitives, rays);
}

TEST(VisitCount, HasNotGrown) {
  constexpr double kNodesOfRay = 8.633, kPacketsOfRay = 4.360;
  const accel::VisitCounts counts = visits_of_ball();
  EXPECT_LE(static_cast<double>(counts.nodes) / kRays, kMargin * kNodesOfRay);
  EXPECT_LE(static_cast<double>(counts.packets) / kRays, kMargin * kPacketsOfRay);
  EXPECT_GT(counts.nodes, 0u);
}

TEST(VisitCount, OfNothingIsZero) {
  const Ray ray{{0, 0, 0}, {0, 0, 1}};
  const accel::VisitCounts counts = accel::Bvh().count_visits(Primitives(), {&ray, 1});
  EXPECT_EQ(counts.nodes + counts.packets, 0u);
}

}  // namespace
}  // namespace tessera::core
