// SPDX-License-Identifier: Apache-2.0
// Instances that move while the shutter is open: a ray finds, to the bit, what it finds where they stand at
// its time.
#include <gtest/gtest.h>

#include "core/geometry/moving_placement.hpp"
#include "tests/unit/core_geometry/batches.hpp"

namespace tessera::core {
namespace {

constexpr FrameInterval kShutter{2.25f, 3.5f};

Track<Vec3> random_track(test::Random& random, Vec3 around, float by) {
  Track<Vec3> track;
  for (const float frame : {1.0f, 2.5f, 3.125f, 4.0f}) {
    track.frames.push_back(frame);
    track.values.push_back(around + random.in_box(by));
  }
  return track;
}

Track<Quaternion> random_turns(test::Random& random) {
  Track<Quaternion> track;
  for (const float frame : {2.0f, 3.0f, 4.0f}) {
    track.frames.push_back(frame);
    track.values.push_back(rotation_quaternion(random.direction(), random.uniform(-180, 180)));
  }
  return track;
}

// All kinds of steps.
std::vector<MotionStep> random_motion(test::Random& random) {
  return {test::random_transform(random, 0.5f), ScaleMotion{random_track(random, {1, 1, 1}, 0.5f)},
          TurnMotion{random.direction(), {{2, 4}, {random.uniform(-720, 0), random.uniform(0, 720)}}},
          RotationMotion{random_turns(random)}, TranslationMotion{random_track(random, {}, 2)}};
}

struct Moving {
  test::Soup soup;
  std::vector<std::vector<MotionStep>> motions;
};

// Instances that move among others and shapes that do not.
Moving moving_instances(test::Random& random) {
  Primitives primitives = test::icosphere(1, {}, 0.5f).primitives();
  Primitives object = test::icosphere(2, {0.3f, 0, 0}, 0.7f).primitives();
  object.add_sphere({0, 0.8f, 0}, 0.3f, 0);
  primitives.add_object(std::move(object));
  for (int i = 0; i < 3; ++i) primitives.add_instance({Placement(test::random_transform(random, 2)), 0});
  Moving moving{{"moving", std::move(primitives), 3}, {}};
  for (std::uint32_t i = 0; i < 12; ++i) {
    moving.motions.push_back(random_motion(random));
    moving.soup.primitives.add_instance({Placement(transform_at(moving.motions[i], 0)), 0});
    moving.soup.primitives.move_instance(3 + i, {moving.motions[i], kShutter});
  }
  return moving;
}

// Where all stand at a time.
Primitives still_at(const Moving& moving, float time) {
  Primitives still = moving.soup.primitives;
  still.stop_instances();
  for (std::uint32_t i = 0; i < moving.motions.size(); ++i)
    still.place_instance(3 + i, Placement(transform_at(moving.motions[i], kShutter.at(time))));
  return still;
}

test::Rays at_times(test::Rays rays, test::Random& random) {
  for (Ray& ray : rays) ray.time = random.uniform(0, 1);
  return rays;
}

// Also tests that the bounds hold: a ray that misses a box it should meet finds something else.
TEST(MovingInstances, AreHitWhereTheyStandAtTheTimeOfTheRay) {
  test::Random random(51);
  const Moving moving = moving_instances(random);
  const Primitives& primitives = moving.soup.primitives;
  const accel::Bvh bvh = accel::Bvh::build(primitives, 1);
  int hit_moving = 0;
  for (int step = 0; step <= 16; ++step) {
    const float time = static_cast<float>(step) / 16;
    const Primitives still = still_at(moving, time);
    const accel::Bvh bvh_of_still = accel::Bvh::build(still, 1);
    for (Ray ray : test::random_rays({"", still, 3}, random, 300)) {
      ray.time = time;
      const Hit found = bvh.closest_hit(primitives, ray), expected = bvh_of_still.closest_hit(still, ray);
      ASSERT_TRUE(test::identical(found, expected)) << time << ' ' << test::describe(ray, expected);
      EXPECT_EQ(bvh.any_hit(primitives, ray), expected.found());
      if (!found.in_instance()) continue;
      EXPECT_EQ(found.time, time);
      hit_moving += found.instance >= 3;
      const SurfacePoint point = primitives.surface(ray, found), same = still.surface(ray, expected);
      EXPECT_EQ(point.position, same.position);
      EXPECT_EQ(point.geometric_normal, same.geometric_normal);
      EXPECT_EQ(primitives.tangents(found, point).along_u, still.tangents(expected, same).along_u);
    }
  }
  EXPECT_GT(hit_moving, 500);
}

TEST(MovingInstances, AreHitByGroupsAsByEachRayAlone) {
  test::Random random(52);
  for (int scene = 0; scene < 4; ++scene) {
    const Moving moving = moving_instances(random);
    const test::Soup& soup = moving.soup;
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
    for (const std::size_t count : {9u, 64u, 300u}) {
      for (const float pixel : {1e-3f, 0.1f})
        test::expect_same_answers(bvh, soup.primitives,
                                  at_times(test::camera_rays(soup, random, count, pixel), random));
      test::expect_same_answers(bvh, soup.primitives,
                                at_times(test::random_rays(soup, random, count), random));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(MovingInstances, ThatDoNotMoveMeanwhileStandStill) {
  EXPECT_FALSE(moves({TranslationMotion{{{0, 1}, {{0, 0, 0}, {1, 0, 0}}}}}, {1, 2}));
  EXPECT_FALSE(moves({TranslationMotion{{{0, 1}, {{0, 0, 0}, {1, 0, 0}}}}}, {0.5f, 0.5f}));
  EXPECT_FALSE(moves({translation({1, 2, 3})}, {0, 1}));
  EXPECT_TRUE(moves({TranslationMotion{{{0, 1}, {{0, 0, 0}, {1, 0, 0}}}}}, {0.75f, 2}));
}

// The greatest values of steps multiply to more than a double holds.
TEST(MovingInstances, HaveBoundsWhenTheBoundsOfTheirMotionOverflow) {
  const ScaleMotion grows{{{0, 3e38f}, {{1, 1, 1}, {3e38f, 3e38f, 3e38f}}}},
      rests{{{0, 1}, {{1, 1, 1}, {1, 1, 1}}}};
  std::vector<MotionStep> steps(9, grows);
  steps.push_back(rests);
  EXPECT_TRUE(moves(steps, {0, 1}));
  const Aabb box = MovingPlacement(steps, {0, 1}).bounds({{{-1, -1, -1}, {1, 1, 1}}});
  EXPECT_LE(box.lower.x, -512);
  EXPECT_GE(box.upper.x, 512);
}

// Along a straight line, the bounds are those at the ends.
TEST(MovingInstances, HaveTightBoundsOnStraightPaths) {
  const MovingPlacement straight({TranslationMotion{{{0, 1}, {{0, 0, 0}, {8, 0, 0}}}}}, {0, 1});
  const Aabb box = straight.bounds({{{-1, -1, -1}, {1, 1, 1}}});
  EXPECT_NEAR(box.lower.x, -1, 2e-4);
  EXPECT_NEAR(box.upper.x, 9, 2e-4);
  EXPECT_NEAR(box.upper.y, 1, 2e-4);
}

// A quarter turn of a rod sweeps a quarter disk.
TEST(MovingInstances, HaveTightBoundsWhenTheyTurn) {
  const MovingPlacement turning({TurnMotion{{0, 0, 1}, {{0, 1}, {0, 90}}}}, {0, 1});
  const Aabb box = turning.bounds({{{0, 0, 0}, {1, 0, 0}}});
  EXPECT_NEAR(box.lower.x, 0, 2e-3);
  EXPECT_NEAR(box.upper.x, 1, 2e-3);
  EXPECT_NEAR(box.upper.y, 1, 2e-3);
  EXPECT_GE(box.upper.y, 1);
}

}  // namespace
}  // namespace tessera::core
