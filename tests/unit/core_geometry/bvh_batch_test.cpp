// SPDX-License-Identifier: Apache-2.0
// Rays asked for together get, bit for bit, the answers that they get one by one, whatever their company.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/effort.hpp"
#include "tests/unit/core_geometry/batches.hpp"

namespace tessera::core {
namespace {

class Batch : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Batch, AnswersAsOneByOne) {
  for (const test::Soup& soup : test::all_soups(GetParam())) {
    SCOPED_TRACE(soup.name);
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 2);
    test::Random random(11);
    // At last more than are sorted at a time.
    for (const std::size_t count :
         {0u, 1u, 2u, 7u, 8u, 9u, 15u, 16u, 17u, 33u, 63u, 64u, 65u, 200u, 512u, 600u}) {
      for (const float pixel : {0.0f, 1e-4f, 0.01f, 0.3f}) {
        test::expect_same_answers(bvh, soup.primitives, test::camera_rays(soup, random, count, pixel));
      }
      test::expect_same_answers(bvh, soup.primitives, test::lamp_rays(soup, random, count, true));
      test::expect_same_answers(bvh, soup.primitives, test::lamp_rays(soup, random, count, false));
      test::expect_same_answers(bvh, soup.primitives, test::random_rays(soup, random, count));
      test::expect_same_answers(bvh, soup.primitives, test::parallel_rays(random, count));
      if (HasFatalFailure()) return;
    }
  }
}

// Neighbours that go the same way are traced as they come, all others of a run sorted.
TEST_P(Batch, AnswersAsOneByOneWhereOnlySomeNeighboursGoTheSameWay) {
  for (const test::Soup& soup : test::all_soups(GetParam())) {
    SCOPED_TRACE(soup.name);
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
    test::Random random(14);
    test::Rays rays;
    const auto append = [&rays](const test::Rays& more) {
      rays.insert(rays.end(), more.begin(), more.end());
    };
    for (int i = 0; i < 6; ++i) {
      append(test::camera_rays(soup, random, 128, 1e-3f));
      append(test::random_rays(soup, random, 64));
      append(test::camera_rays(soup, random, 32, 1e-3f));
      append(test::camera_rays(soup, random, 32, 1e-3f));
    }
    append(test::camera_rays(soup, random, 5, 1e-3f));
    test::expect_same_answers(bvh, soup.primitives, rays);
    if (HasFatalFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Batch,
                         testing::Values(1, 33, 400, tessera::test::kEffortDivisor == 1 ? 1500 : 700));

// As long as the box that they fill, so that their boxes overlap by far.
test::Soup long_needles(test::Random& random) {
  test::Mesh mesh;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 middle = random.in_box(1), along = random.direction(), across = random.in_box(0.002f);
    mesh.add({middle - along, middle + along, middle + along + across});
  }
  return {"needles", mesh.primitives(), 1};
}

Primitives instance_of(const Primitives& object) {
  Primitives primitives;
  primitives.add_object(object);
  primitives.add_instance({Placement(Transform{}), 0});
  return primitives;
}

// Rays that scatter so widely that each keeps more nodes for itself than there is room for.
TEST(Batch, AnswersAsOneByOneAmongNeedles) {
  test::Random random(13);
  const test::Soup needles = long_needles(random),
                   shown = {"an instance of needles", instance_of(needles.primitives), 1};
  for (const test::Soup* soup : {&needles, &shown}) {
    SCOPED_TRACE(soup->name);
    const accel::Bvh bvh = accel::Bvh::build(soup->primitives, 2);
    for (const std::size_t count : {80u, 600u})
      test::expect_same_answers(bvh, soup->primitives, test::random_rays(*soup, random, count));
    test::expect_same_answers(bvh, soup->primitives, test::lamp_rays(*soup, random, 600, true));
  }
}

TEST(Batch, SurvivesRaysThatAreNotRaysAmongOthers) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const test::Soup& soup : test::all_soups(400)) {
    SCOPED_TRACE(soup.name);
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
    test::Random random(12);
    for (const float bad : {nan, kInfinity, -kInfinity, 0.0f})
      ASSERT_NO_FATAL_FAILURE(test::expect_same_answers_beside(bad, bvh, soup, random));
  }
}

TEST(Batch, OfNothingIsMissed) {
  const test::Rays rays(70, Ray{{0, 0, 0}, {0, 0, 1}});
  test::expect_same_answers(accel::Bvh(), Primitives(), rays);
}

}  // namespace
}  // namespace tessera::core
