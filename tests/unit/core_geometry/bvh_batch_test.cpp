// Rays asked for together get, bit for bit, the answers that they get one by one, whatever their company.
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

using Rays = std::vector<Ray>;

// `count` rays through neighbouring pixels of a pinhole camera, in blocks of 8 * 8, of `pixel` width on a
// screen at distance 1.
Rays camera_rays(const test::Soup& soup, test::Random& random, std::size_t count, float pixel) {
  const Vec3 eye = random.in_box(soup.half_size);
  const Vec3 to_target = test::point_of(soup.primitives, random) - eye;
  const Vec3 forward =
      length(to_target) > 0 && is_finite(to_target) ? to_target / length(to_target) : random.direction();
  const Vec3 right = normalize(cross(forward, random.direction())), up = cross(right, forward);
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = static_cast<float>(i % 8 + i / 64 * 8), y = static_cast<float>(i / 8 % 8);
    rays.push_back({eye, forward + right * (pixel * x) + up * (pixel * y)});
  }
  return rays;
}

// From points of the primitives to points of a small lamp, or from the lamp to them.
Rays lamp_rays(const test::Soup& soup, test::Random& random, std::size_t count, bool to_lamp) {
  const Vec3 lamp = random.in_box(soup.half_size);
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 on_lamp = lamp + random.in_box(0.05f * soup.half_size);
    const Vec3 on_surface = test::point_of(soup.primitives, random);
    rays.push_back(to_lamp ? Ray{on_surface, on_lamp - on_surface, 1} : Ray{on_lamp, on_surface - on_lamp});
  }
  return rays;
}

Rays random_rays(const test::Soup& soup, test::Random& random, std::size_t count) {
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) rays.push_back(test::random_ray(soup, random));
  return rays;
}

// Along one axis, from a grid whose points often lie above corners and edges.
Rays parallel_rays(test::Random& random, std::size_t count) {
  Vec3 direction;
  const int axis = static_cast<int>(random.below(3));
  direction[axis] = random.below(2) == 0 ? 1.0f : -1.0f;
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 origin;
    origin[axis] = -3 * direction[axis];
    origin[(axis + 1) % 3] = 0.5f * static_cast<float>(i % 8) - 2;
    origin[(axis + 2) % 3] = 0.5f * static_cast<float>(i / 8 % 8) - 2;
    rays.push_back({origin, direction});
  }
  return rays;
}

void expect_same_answers(const Bvh& bvh, const Primitives& primitives, const Rays& rays) {
  std::vector<Hit> hits(rays.size(), Hit{0, 0, 0, 0});
  std::vector<std::uint8_t> occluded(rays.size(), 2);
  bvh.closest_hits(primitives, rays, hits);
  bvh.any_hits(primitives, rays, occluded);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit expected = bvh.closest_hit(primitives, rays[i]);
    ASSERT_TRUE(test::identical(hits[i], expected))
        << i << " of " << rays.size() << "\nexpected " << test::describe(rays[i], expected) << "\n     got "
        << test::describe(rays[i], hits[i]);
    ASSERT_EQ(occluded[i], expected.found() ? 1 : 0) << test::describe(rays[i], expected);
  }
}

class Batch : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Batch, AnswersAsOneByOne) {
  for (const test::Soup& soup : test::all_soups(GetParam())) {
    SCOPED_TRACE(soup.name);
    const Bvh bvh = Bvh::build(soup.primitives, 2);
    test::Random random(11);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 8u, 63u, 64u, 65u, 200u, 1000u}) {
      for (const float pixel : {0.0f, 1e-4f, 0.01f, 0.3f}) {
        expect_same_answers(bvh, soup.primitives, camera_rays(soup, random, count, pixel));
      }
      expect_same_answers(bvh, soup.primitives, lamp_rays(soup, random, count, true));
      expect_same_answers(bvh, soup.primitives, lamp_rays(soup, random, count, false));
      expect_same_answers(bvh, soup.primitives, random_rays(soup, random, count));
      expect_same_answers(bvh, soup.primitives, parallel_rays(random, count));
      if (HasFatalFailure()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Batch, testing::Values(1, 33, 400, 3000));

TEST(Batch, SurvivesRaysThatAreNotRaysAmongOthers) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const test::Soup& soup : test::all_soups(400)) {
    SCOPED_TRACE(soup.name);
    const Bvh bvh = Bvh::build(soup.primitives, 1);
    test::Random random(12);
    for (const float bad : {nan, kInfinity, -kInfinity, 0.0f}) {
      for (Rays rays : {camera_rays(soup, random, 64, 0.01f), random_rays(soup, random, 64)}) {
        rays[3].direction = {bad, bad, bad};
        rays[8].origin.y = bad;
        rays[30].direction.z = bad;
        rays[31].t_max = bad;
        rays[32].t_max = -1;
        expect_same_answers(bvh, soup.primitives, rays);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(Batch, OfNothingIsMissed) {
  const Rays rays(70, Ray{{0, 0, 0}, {0, 0, 1}});
  expect_same_answers(Bvh(), Primitives(), rays);
}

}  // namespace
}  // namespace tessera::core
