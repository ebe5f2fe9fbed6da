// SPDX-License-Identifier: Apache-2.0
// Scenes that show one frame after the other: interpolation in closed form, and the bytes of their images.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "core/integrators/render.hpp"
#include "core/scene/animation.hpp"
#include "core/scene/pose.hpp"
#include "core/scene/scene.hpp"
#include "tests/support/near.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

using testing::HasSubstr;

TEST(AnimationTrack, IsLinearBetweenKeyframesAndConstantOutside) {
  const Track<float> track{{10, 20, 24}, {1, 3, -1}};
  EXPECT_EQ(value_at(track, -5, 7.0f), 1);
  EXPECT_EQ(value_at(track, 10, 7.0f), 1);
  EXPECT_EQ(value_at(track, 15, 7.0f), 2);
  EXPECT_EQ(value_at(track, 20, 7.0f), 3);
  EXPECT_EQ(value_at(track, 23, 7.0f), 0);
  EXPECT_EQ(value_at(track, 24, 7.0f), -1);
  EXPECT_EQ(value_at(track, 1000, 7.0f), -1);
  EXPECT_EQ(value_at(Track<float>{}, 12, 7.0f), 7) << "not animated";
}

TEST(AnimationTrack, OfPointsIsLinearInEachCoordinate) {
  const Track<Vec3> track{{0, 4}, {{0, 8, 2}, {4, 0, 2}}};
  EXPECT_EQ(value_at(track, 1, Vec3{}), (Vec3{1, 6, 2}));
}

// A turn about a fixed axis may be more than half a turn from keyframe to keyframe.
TEST(AnimatedTransform, TurnsAsOftenAsItsKeyframesSay) {
  const std::vector<MotionStep> steps{translation({1, 0, 0}), TurnMotion{{0, 1, 0}, {{0, 8}, {0, 720}}}};
  expect_near(transform_at(steps, 1).point({}), {0, 0, -1}, 1e-6f);
  expect_near(transform_at(steps, 2).point({}), {-1, 0, 0}, 1e-6f);
  expect_near(transform_at(steps, 6).point({}), {-1, 0, 0}, 1e-6f);
}

TEST(AnimatedTransform, AppliesItsStepsInTheirOrder) {
  const std::vector<MotionStep> steps{
      ScaleMotion{{{0, 2}, {{1, 1, 1}, {3, 3, 3}}}},
      RotationMotion{{{0, 2}, {Quaternion{}, rotation_quaternion({0, 0, 1}, 120)}}},
      TranslationMotion{{{0, 2}, {{0, 0, 0}, {10, 0, 0}}}}};
  expect_near(transform_at(steps, 1).point({1, 0, 0}), {6, 1.7320508f, 0}, 1e-5f);
}

// The room, with a moving mirror ball in an object of its own, a moving lamp, and a camera on its way.
SceneDescription animated_room() {
  SceneDescription room = test::room();
  room.objects = {
      {"ball",
       {SphereDescription{{}, 0.25f, 4}, QuadDescription{{0, 0.3f, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}, 3}},
       {}}};
  room.shapes.erase(room.shapes.begin() + 6);
  room.shapes.push_back(InstanceDescription{0, {}, std::nullopt});
  room.lights = {PointLightDescription{{0, 1.5f, 0.5f}, {1, 1, 1}}};
  room.animation.instances = {{static_cast<std::uint32_t>(room.shapes.size()) - 1,
                               {TurnMotion{{0, 1, 0}, {{0, 10}, {0, 400}}},
                                TranslationMotion{{{0, 10}, {{-0.5f, 0.4f, 0}, {0.5f, 0.9f, 0}}}}}}};
  room.animation.lights = {{.light = 0, .color = {{0, 10}, {{0, 0, 0}, {2, 1, 1}}}}};
  room.animation.camera.position = {{0, 10}, {{0, 1, 3.8f}, {0.5f, 1, 3.6f}}};
  const float begin = 0;
  std::get<InstanceDescription>(room.shapes.back()).to_world =
      transform_at(room.animation.instances[0].steps, begin);
  room.lights = {PointLightDescription{{0, 1.5f, 0.5f}, {0, 0, 0}}};
  return room;
}

// The same without keyframes, as it is at a frame.
SceneDescription still_room(int frame) {
  SceneDescription room = animated_room();
  const Pose pose = *PoseMaker(room).at(frame);
  room.camera = pose.camera;
  room.lights = pose.lights;
  std::get<InstanceDescription>(room.shapes.back()).to_world = pose.placements[0];
  room.animation = {};
  return room;
}

std::vector<std::uint64_t> sums(const Scene& scene) {
  const RenderSettings& settings = scene.settings();
  return render(prepare(scene, settings, 2), {0, 0, settings.width_px, settings.height_px}, {0, 4}, 2).sums;
}

TEST(Frames, AreThoseOfAStillSceneInAnyOrder) {
  Scene scene = Scene::build(animated_room(), 2).value();
  for (const int frame : {3, 10, 0, 7, 7, 3}) {
    ASSERT_TRUE(scene.set_frame(frame, 2));
    EXPECT_EQ(scene.frame(), frame);
    const Scene still = Scene::build(still_room(frame), 2).value();
    EXPECT_TRUE(sums(scene) == sums(still)) << "frame " << frame;
    EXPECT_TRUE(scene.bvh() == still.bvh()) << "frame " << frame;
    EXPECT_EQ(scene.lights().size(), still.lights().size());
  }
}

// A room whose surfaces, sky and fog change.
SceneDescription changing_room() {
  SceneDescription room = test::room();
  room.materials[1].model = Principled{.base_weight = 0.9f, .transmission_depth = 2};
  room.media = {{.name = "fog", .sigma_a = Rgb::gray(0.1f)}};
  room.materials[4].media.interior = 0;
  room.environment = EnvironmentDescription{ColorParameter{Rgb{}}, 10};
  Animation& a = room.animation;
  a.materials = {{0, {{{"opacity", {{0, 10}, {1, 0.5f}}}}, {{"albedo", {{0, 10}, {{1, 0, 0}, {0, 1, 0}}}}}}},
                 {1, {{{"transmission_weight", {{0, 10}, {0, 1}}}}, {}}},
                 {3, {{}, {{"emission", {{0, 10}, {{0, 0, 0}, {3, 3, 3}}}}}}}};
  a.media = {{0, {{{"scale", {{0, 10}, {1, 3}}}}, {}}}};
  a.environment = {{{"rotation_degrees", {{0, 10}, {10, 90}}}},
                   {{"radiance", {{0, 10}, {{0, 0, 0}, {0, 1, 2}}}}}};
  room.materials[0].model = Lambert{{{1, 0, 0}, -1}};
  room.materials[3].emission = ColorParameter{Rgb{}};
  return room;
}

// What changing_room() is at a frame, by hand.
SceneDescription changed_room(int frame) {
  SceneDescription room = changing_room();
  const float t = static_cast<float>(frame) / 10;
  room.animation = {};
  room.materials[0].opacity = 1 - 0.5f * t;
  room.materials[0].model = Lambert{{{1 - t, t, 0}, -1}};
  std::get<Principled>(room.materials[1].model).transmission_weight = t;
  room.materials[3].emission = ColorParameter{Rgb{3 * t, 3 * t, 3 * t}};
  room.media[0].scale = 1 + 2 * t;
  room.environment->rotation_degrees = 10 + 80 * t;
  room.environment->radiance = ColorParameter{Rgb{0, t, 2 * t}};
  return room;
}

TEST(Frames, HaveTheMaterialsMediaAndEnvironmentOfTheirTime) {
  Scene scene = Scene::build(changing_room(), 1).value();
  for (const int frame : {5, 0, 10, 5}) {
    ASSERT_TRUE(scene.set_frame(frame, 1));
    const Scene still = Scene::build(changed_room(frame), 1).value();
    EXPECT_TRUE(sums(scene) == sums(still)) << "frame " << frame;
    EXPECT_EQ(scene.lights().size(), still.lights().size()) << "frame " << frame;
    EXPECT_EQ(scene.media().size(), still.media().size()) << "frame " << frame;
    EXPECT_EQ(scene.is_opaque(), still.is_opaque()) << "frame " << frame;
  }
}

TEST(Frames, OfParametersOutOfRangeAreRefusedByTheBuild) {
  const auto refusal = [](const auto& change) {
    SceneDescription room = changing_room();
    change(room.animation);
    const Result<Scene> built = Scene::build(room, 1);
    return built ? std::string() : built.error().message;
  };
  EXPECT_EQ(refusal([](Animation&) {}), "");
  EXPECT_THAT(refusal([](Animation& a) { a.materials[0].tracks.numbers[0].track.values[1] = 2; }),
              HasSubstr("opacity must be between 0 and 1"));
  EXPECT_THAT(refusal([](Animation& a) { a.materials[2].tracks.colors[0].track.values[1].g = -1; }),
              HasSubstr("emission must be 0 or greater, got ["));
  EXPECT_THAT(refusal([](Animation& a) { a.media[0].tracks.numbers[0].track.values[0] = -1; }),
              HasSubstr("medium 'fog'"));
  EXPECT_THAT(refusal([](Animation& a) { a.environment.colors[0].track.values[1].r = -1; }),
              HasSubstr("environment: radiance"));
  EXPECT_THAT(refusal([](Animation& a) { a.materials[0].index = 99; }), HasSubstr("there is no material 99"));
  EXPECT_THAT(refusal([](Animation& a) { a.media[0].index = 1; }), HasSubstr("there is no medium 1"));
  EXPECT_THAT(refusal([](Animation& a) { a.environment.numbers[0].track.values.pop_back(); }),
              HasSubstr("must be numbers that increase"));
}

TEST(Frames, DifferFromEachOther) {
  Scene scene = Scene::build(animated_room(), 2).value();
  const auto first = sums(scene);
  ASSERT_TRUE(scene.set_frame(1, 2));
  EXPECT_FALSE(sums(scene) == first);
}

TEST(Frames, ShareTheTreesOfObjectsAndAllGeometry) {
  Scene scene = Scene::build(animated_room(), 1).value();
  const void* const nodes = scene.bvh().arrays().objects[0].nodes.data();
  const Primitives* const objects = scene.primitives().objects().data();
  ASSERT_TRUE(scene.set_frame(5, 1));
  EXPECT_EQ(scene.bvh().arrays().objects[0].nodes.data(), nodes);
  EXPECT_EQ(scene.primitives().objects().data(), objects);
}

// Where the camera alone moves, nothing is built again.
TEST(Frames, OfAMovingCameraShareTheWholeTree) {
  SceneDescription room = animated_room();
  room.animation.instances.clear();
  room.animation.lights.clear();
  Scene scene = Scene::build(room, 1).value();
  const void* const nodes = scene.bvh().arrays().nodes.data();
  const lights::Light* const lights = scene.lights().data();
  ASSERT_TRUE(scene.set_frame(5, 1));
  EXPECT_EQ(scene.bvh().arrays().nodes.data(), nodes);
  EXPECT_EQ(scene.lights().data(), lights);
  EXPECT_NE(sums(scene), sums(Scene::build(room, 1).value()));
}

TEST(Frames, OfAStillSceneAreTheSame) {
  Scene scene = Scene::build(test::room(), 1).value();
  const auto first = sums(scene);
  ASSERT_TRUE(scene.set_frame(12, 1));
  EXPECT_TRUE(sums(scene) == first);
}

TEST(Frames, ThatCannotBeRenderedAreNamedAndChangeNothing) {
  SceneDescription room = animated_room();
  room.shape_names.assign(room.shapes.size(), "");
  room.shape_names.back() = "shapes[8]";
  room.animation.instances[0].steps.emplace_back(ScaleMotion{{{0, 10}, {{1, 1, 1}, {-1, 1, 1}}}});
  room.animation.camera.look_at = {{0, 8}, {{0, 1, 0}, {0.4f, 1, 3.64f}}};
  Scene scene = Scene::build(room, 1).value();
  const auto first = sums(scene);
  const Status flat = scene.set_frame(5, 1);
  ASSERT_FALSE(flat);
  EXPECT_EQ(flat.error().message,
            "frame 5: shapes[8]: the transform flattens the object, or scales or moves it too far to be "
            "computed");
  EXPECT_EQ(scene.frame(), 0);
  EXPECT_TRUE(sums(scene) == first);
  const std::vector<std::int32_t> fine{0, 1, 9}, wrong{0, 1, 5};
  EXPECT_TRUE(validate_frames(room, fine));
  EXPECT_THAT(validate_frames(room, wrong).error().message, HasSubstr("frame 5: "));
}

TEST(Frames, OfEmissiveSpheresThatDoNotStayRoundAreRefused) {
  SceneDescription room = animated_room();
  std::get<SphereDescription>(room.objects[0].shapes[0]).material = 3;
  room.animation.instances[0].steps.emplace_back(ScaleMotion{{{0, 10}, {{1, 1, 1}, {1, 2, 1}}}});
  const std::vector<std::int32_t> frames{5};
  EXPECT_THAT(validate_frames(room, frames).error().message, HasSubstr("must stay round"));
}

TEST(Frames, OfUnsoundAnimationsAreRefusedByTheBuild) {
  const auto refused = [](const auto& change) {
    SceneDescription room = animated_room();
    change(room.animation);
    return !Scene::build(room, 1);
  };
  EXPECT_TRUE(refused([](Animation& a) { a.camera.position.frames = {3, 3}; }));
  EXPECT_TRUE(refused([](Animation& a) { a.camera.position.values.pop_back(); }));
  EXPECT_TRUE(refused([](Animation& a) { a.lights[0].light = 1; }));
  EXPECT_TRUE(refused([](Animation& a) { a.instances[0].shape = 0; }));
  EXPECT_TRUE(refused([](Animation& a) { a.instances[0].shape = 99; }));
  EXPECT_TRUE(
      refused([](Animation& a) { std::get<TurnMotion>(a.instances[0].steps[0]).degrees.values[0] = 1e9f; }));
}

}  // namespace
}  // namespace tessera::core::integrators
