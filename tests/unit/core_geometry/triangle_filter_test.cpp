// SPDX-License-Identifier: Apache-2.0
// What the filter of triangles is sure of is so, of rays whose origins are floats and of those that are not.
#include "core/accel/triangle_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>
#include <vector>

#include "core/accel/ray_group.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core::accel {
namespace {

template <typename AnyRay>
class SureOfTriangles : public testing::Test {};
using KindsOfRay = testing::Types<Ray, ObjectRay>;
TYPED_TEST_SUITE(SureOfTriangles, KindsOfRay);

// From up to `height` before the triangle at a point of it, or beside by anything up to `beside`. Of one
// octant.
template <typename AnyRay>
AnyRay ray_at(const TriangleCorners& corners, float height, float beside, test::Random& random) {
  const Vec3 w = random.weights();
  const Vec3d target = Vec3d(w.x * corners[0] + w.y * corners[1] + w.z * corners[2]);
  const Vec3d direction(Vec3{random.uniform(0.1f, 0.6f), random.uniform(0.1f, 0.6f), 1});
  const Vec3d back = static_cast<double>(-height * random.uniform(0.5f, 1)) * direction;
  const Vec3d origin = target + back + Vec3d(random.in_box(beside * std::exp2(random.uniform(-26, 0))));
  if constexpr (std::is_same_v<AnyRay, Ray>) {
    return {origin.rounded(), direction.rounded()};
  } else {
    return {origin, direction, std::numeric_limits<float>::infinity()};
  }
}

struct Sure {
  int outside = 0, inside = 0;
};

template <typename AnyRay>
void expect_sure_of_what_is(const TriangleCorners& corners, float height, float beside, test::Random& random,
                            Sure& sure) {
  std::vector<AnyRay> some;
  for (int i = 0; i < static_cast<int>(kVectorLanes); ++i)
    some.push_back(ray_at<AnyRay>(corners, height, beside, random));
  const RayColumns<AnyRay> rays(some.size(), [&](std::size_t i) -> const AnyRay& { return some[i]; });
  const RayGroup<AnyRay> group(rays);
  ASSERT_TRUE(group.can_filter());
  const FilterRays lanes = group.filter_rays(0);
  const TriangleFilter filter(lanes, [&](int corner, int axis) {
    return FloatVector(corners[static_cast<std::size_t>(corner)][group.filter_axes()[axis]]);
  });
  alignas(kVectorAlignment) float low[kVectorLanes], high[kVectorLanes];
  filter.t(lanes).low.store(low);
  filter.t(lanes).high.store(high);
  for (std::size_t i = 0; i < kVectorLanes; ++i) {
    const auto hit = intersect_triangle(ShearedRay(rays.ray(i)), corners);
    if ((filter.surely_outside().bits() >> i & 1) != 0) {
      ++sure.outside;
      ASSERT_FALSE(hit);
    }
    if ((filter.surely_inside().bits() >> i & 1) == 0 || !(low[i] > 0)) continue;
    ++sure.inside;
    ASSERT_TRUE(hit);
    ASSERT_LE(low[i], hit->t);
    ASSERT_GE(high[i], hit->t);
  }
}

TYPED_TEST(SureOfTriangles, NearAndFarLargeAndSmallWhereverTheyWereModelled) {
  test::Random random(31);
  for (const float far : {0.0f, 3.0f, 30000.0f})
    for (const float size : {1.0f, 100.0f, 0.01f})
      for (const float height : {1e-3f, 0.1f, 30.0f}) {
        Sure sure;
        for (int i = 0; i < 4000; ++i) {
          const Vec3 center = far * Vec3{0.6f, 0.5f, 1};
          const TriangleCorners corners = {center + random.in_box(size), center + random.in_box(size),
                                           center + random.in_box(size)};
          expect_sure_of_what_is<TypeParam>(corners, height * size, size, random, sure);
          if (this->HasFatalFailure()) return;
        }
        if (far > 3) continue;
        EXPECT_GT(sure.inside, 300) << far << ' ' << size << ' ' << height;
        EXPECT_GT(sure.outside, 300) << far << ' ' << size << ' ' << height;
      }
}

}  // namespace
}  // namespace tessera::core::accel
