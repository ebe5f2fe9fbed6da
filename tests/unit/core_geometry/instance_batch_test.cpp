// SPDX-License-Identifier: Apache-2.0
// Groups of rays that go on through instances: to the bit what every ray finds alone, and what asking every
// primitive of every instance finds, wherever and however an object is shown and wherever it was modelled.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "tests/unit/core_geometry/batches.hpp"

namespace tessera::core {
namespace {

// What is modelled within about 1 of `center`.
Primitives body(Vec3 center) {
  Primitives made = test::icosphere(3, center, 1).primitives();
  made.add_sphere(center + Vec3{0.3f, 0.9f, 0}, 0.4f, 0);
  return made;
}

// Edges and corners at multiples of an eighth: rays along the axes meet them exactly.
Primitives sheets(Vec3 center) {
  test::Mesh mesh;
  for (int layer = -1; layer <= 1; ++layer)
    for (int y = -8; y < 8; ++y)
      for (int x = -8; x < 8; ++x) {
        const auto corner = [&](int dx, int dy) {
          return center + 0.125f * Vec3{static_cast<float>(x + dx), static_cast<float>(y + dy),
                                        static_cast<float>(4 * layer)};
        };
        mesh.add({corner(0, 0), corner(1, 0), corner(1, 1)});
        mesh.add({corner(0, 0), corner(1, 1), corner(0, 1)});
      }
  return mesh.primitives();
}

// How large instances are, how far from the origin of the world they stand, and how far from that of its own
// space the object was modelled, both in units of its size.
struct Show {
  float size, distance, modelled_at;
};

// The map that shows at `place`, `size` as large, what was modelled at `center`.
Transform placement_at(test::Random& random, const Show& show, Vec3 center) {
  Transform turned = compose(scaling({show.size, show.size, show.size}), test::random_transform(random, 0));
  turned.origin = {};
  const Vec3 place = show.size * (show.distance * Vec3{0.6f, -0.64f, 0.48f} + random.in_box(1.5f));
  turned.origin = place - turned.point(center);
  return turned;
}

// Overlapping, turned, mirrored, scaled by different factors along the axes; each third where the one before
// it is, and one whose shapes are the scene's own as well.
test::Soup shown(const Show& show, test::Random& random) {
  const Vec3 center = show.modelled_at * Vec3{0.48f, 0.6f, -0.64f};
  Primitives primitives = body({});
  primitives.add_object(body(center));
  primitives.add_object(sheets(center));
  primitives.add_object(body({}));
  Transform transform;
  for (std::uint32_t i = 0; i < 9; ++i) {
    if (i % 3 != 2) transform = placement_at(random, show, center);
    primitives.add_instance({Placement(transform), i / 3 % 2});
  }
  primitives.add_instance({Placement({}), 2});
  const Transform straight = {{show.size, 0, 0}, {0, -show.size, 0}, {0, 0, show.size}, {}};
  primitives.add_instance({Placement(straight), 1});
  return {"shown", std::move(primitives), 4 * show.size};
}

// From where instances stand, so that rays do not all come from afar.
test::Rays moved(test::Rays rays, Vec3 by) {
  for (Ray& ray : rays) ray.origin = ray.origin + by;
  return rays;
}

void expect_what_brute_force_finds(const accel::Bvh& bvh, const Primitives& primitives,
                                   const test::Rays& rays) {
  const std::vector<Hit> hits = test::closest_hits(bvh, primitives, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit expected = test::brute_force_hit(primitives, rays[i]);
    ASSERT_TRUE(test::identical(hits[i], expected)) << i << "\nexpected " << test::describe(rays[i], expected)
                                                    << "\n     got " << test::describe(rays[i], hits[i]);
  }
}

class GroupsThroughInstances : public testing::TestWithParam<std::tuple<float, float, float>> {
 protected:
  Show show() const {
    const auto [size, distance, modelled_at] = GetParam();
    return {size, distance, modelled_at};
  }
};

TEST_P(GroupsThroughInstances, FindWhatEachRayFindsAlone) {
  test::Random random(21);
  for (int scene = 0; scene < 4; ++scene) {
    const test::Soup soup = shown(show(), random);
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
    const Vec3 place = show().size * show().distance * Vec3{0.6f, -0.64f, 0.48f};
    for (const std::size_t count : {9u, 64u, 300u}) {
      for (const float pixel : {1e-4f, 0.01f, 0.1f}) {
        const test::Rays rays = test::camera_rays(soup, random, count, pixel);
        test::expect_same_answers(bvh, soup.primitives, rays);
        test::expect_same_answers(bvh, soup.primitives, moved(rays, place));
      }
      test::expect_same_answers(bvh, soup.primitives, test::lamp_rays(soup, random, count, true));
      test::expect_same_answers(bvh, soup.primitives, test::lamp_rays(soup, random, count, false));
      test::expect_same_answers(bvh, soup.primitives, test::random_rays(soup, random, count));
      test::expect_same_answers(bvh, soup.primitives, moved(test::random_rays(soup, random, count), place));
      test::expect_same_answers(bvh, soup.primitives, test::parallel_rays(random, count));
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(GroupsThroughInstances, FindWhatBruteForceFinds) {
  test::Random random(22);
  const test::Soup soup = shown(show(), random);
  const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
  for (int i = 0; i < 3; ++i) {
    expect_what_brute_force_finds(bvh, soup.primitives, test::camera_rays(soup, random, 64, 0.03f));
    expect_what_brute_force_finds(bvh, soup.primitives, test::lamp_rays(soup, random, 64, false));
    expect_what_brute_force_finds(bvh, soup.primitives, test::lamp_rays(soup, random, 64, true));
    if (HasFatalFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(SizesAndDistances, GroupsThroughInstances,
                         testing::Combine(testing::Values(1.0f, 1e-6f, 1e6f), testing::Values(0.0f, 1000.0f),
                                          testing::Values(0.0f, 3.0f, 30000.0f)));

// A slanted sheet of cells * cells cells, 8 * 8 across, raised by so many units in the last place of its
// coordinates.
void add_slanted(test::Mesh& mesh, Vec3 center, int cells, int raised) {
  const auto corner = [&](int column, int row) {
    const float x = 8.0f * static_cast<float>(column) / static_cast<float>(cells) - 4;
    const float y = 8.0f * static_cast<float>(row) / static_cast<float>(cells) - 4;
    Vec3 p = center + Vec3{x, y, 0.4f * x - 0.3f * y};
    for (int i = 0; i < raised; ++i) p.z = std::nextafter(p.z, std::numeric_limits<float>::infinity());
    return p;
  };
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      mesh.add({corner(column, row), corner(column + 1, row), corner(column + 1, row + 1)});
      mesh.add({corner(column, row), corner(column + 1, row + 1), corner(column, row + 1)});
    }
}

// From one point near a sheet down at it.
test::Rays rays_from_close_by(test::Random& random, std::size_t count) {
  const float x = random.uniform(-3, 3), y = random.uniform(-3, 3);
  const Vec3 eye{x, y, 0.4f * x - 0.3f * y + random.uniform(0.003f, 0.03f)};
  test::Rays rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back({eye, {random.uniform(-0.5f, 0.5f), random.uniform(-0.5f, 0.5f), -1}});
  return rays;
}

// Sheets so close that float arithmetic cannot tell which is nearer: the scene's own, whose triangles rays
// meet before they come to instances, and three in each object, of cells that are not the same.
TEST(GroupsThroughInstances, TellSurfacesApartThatAreAHairFromEachOther) {
  test::Random random(25);
  for (int scene = 0; scene < 20; ++scene) {
    const Vec3 center = scene % 2 == 0 ? Vec3{} : Vec3{20000, -15000, 30000};
    test::Mesh own, sheets_of_object;
    add_slanted(own, {}, 1, 0);
    add_slanted(sheets_of_object, center, 1, 1);
    add_slanted(sheets_of_object, center, 9, 0);
    add_slanted(sheets_of_object, center, 7, 1);
    test::Soup soup{"hair", own.primitives(), 4};
    soup.primitives.add_object(sheets_of_object.primitives());
    for (int i = 0; i < 4; ++i)
      soup.primitives.add_instance({Placement(translation(random.in_box(3e-7f) - center)), 0});
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
    for (const float pixel : {1e-3f, 0.01f, 0.1f})
      test::expect_same_answers(bvh, soup.primitives, test::camera_rays(soup, random, 640, pixel));
    test::expect_same_answers(bvh, soup.primitives, test::lamp_rays(soup, random, 640, false));
    for (int i = 0; i < 30; ++i)
      test::expect_same_answers(bvh, soup.primitives, rays_from_close_by(random, 64));
    if (HasFatalFailure()) return;
  }
}

// A ray that has met a shape of an instance and then something nearer that is in none: an instance's box
// begins before the scene's triangle, its own triangle lies behind.
TEST(GroupsThroughInstances, GiveUpAnInstanceForWhatIsNearer) {
  const auto facing = [](float z) { return TriangleCorners{Vec3{-9, -9, z}, Vec3{9, -9, z}, Vec3{0, 9, z}}; };
  test::Mesh own, of_object;
  own.add(facing(1));
  of_object.add(facing(2));
  test::Soup soup{"nearer", own.primitives(), 4};
  Primitives object = of_object.primitives();
  object.add_sphere({5, 0, 0.5f}, 0.1f, 0);  // beside the rays
  soup.primitives.add_object(object);
  soup.primitives.add_instance({Placement(Transform{}), 0});
  const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
  test::Random random(26);
  for (const std::size_t count : {13u, 60u, 64u}) {
    test::Rays rays;
    for (std::size_t i = 0; i < count; ++i)
      rays.push_back({{0, 0, 0}, {random.uniform(0.01f, 0.5f), random.uniform(0.01f, 0.5f), 1}});
    expect_what_brute_force_finds(bvh, soup.primitives, rays);
    test::expect_same_answers(bvh, soup.primitives, rays);
    EXPECT_FALSE(bvh.closest_hit(soup.primitives, rays[0]).in_instance());
  }
}

// At edges and corners of a closed mesh, from inside, from one point and from many.
TEST(GroupsThroughInstances, LeakNothingThroughAClosedMesh) {
  test::Random random(23);
  for (int t = 0; t < 24; ++t) {
    const Vec3 center = t % 2 == 0 ? Vec3{5, 0, 0} : Vec3{4000, -3000, 2000};
    Primitives primitives;
    primitives.add_object(test::icosphere(3, center, 1).primitives());
    primitives.add_instance({Placement(placement_at(random, {1, t % 3 == 0 ? 500.0f : 0.0f, 0}, center)), 0});
    const accel::Bvh bvh = accel::Bvh::build(primitives, 1);
    const Placement& placement = primitives.instance(0).placement;
    test::Rays rays(4096);
    const Vec3 from = center + random.in_box(0.4f);
    for (Ray& ray : rays) {
      const Vec3 inside = t % 4 < 2 ? from : center + random.in_box(0.4f);
      ray.origin = placement.point(Vec3d(inside)).rounded();
      ray.direction = test::point_of(primitives, random) - ray.origin;
    }
    const std::vector<Hit> hits = test::closest_hits(bvh, primitives, rays);
    const std::vector<accel::Occlusion> occluded = test::occlusions(bvh, primitives, rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_TRUE(hits[i].found() && occluded[i] == accel::Occlusion::kFull)
          << t << ' ' << test::describe(rays[i], hits[i]);
  }
}

TEST(GroupsThroughInstances, SurviveRaysThatAreNotRaysAmongOthers) {
  constexpr float kUnbounded = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  test::Random random(24);
  const test::Soup soup = shown({1, 0, 3}, random);
  const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
  for (const float bad : {nan, kUnbounded, -kUnbounded, 0.0f, 3e38f})
    ASSERT_NO_FATAL_FAILURE(test::expect_same_answers_beside(bad, bvh, soup, random));
}

}  // namespace
}  // namespace tessera::core
