// SPDX-License-Identifier: Apache-2.0
// Motion blur: closed forms, and the mean of still images at the times of the samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/film/fixed_point.hpp"
#include "core/integrators/render.hpp"
#include "core/scene/scene.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

using testing::HasSubstr;

// Black shapes before a sky of radiance 1, seen from +z by an orthographic camera: a pixel is 1 - coverage.
// `shape` is an object's; it moves as `motion` says while the shutter is open from frame 0 to frame 1.
SceneDescription silhouette(const ShapeDescription& shape, std::vector<MotionStep> motion) {
  test::SceneMaker maker({.position = {0, 0, 5},
                          .look_at = {0, 0, 0},
                          .type = CameraType::kOrthographic,
                          .view_height = 2,
                          .shutter_open = 0,
                          .shutter_close = 1});
  maker.material(test::lambert(0));
  SceneDescription& scene = maker.description();
  scene.objects = {{"moving", {shape}, {}}};
  maker.add(InstanceDescription{0, transform_at(motion, 0), std::nullopt});
  scene.animation.instances = {{0, std::move(motion)}};
  scene.environment = EnvironmentDescription{ColorParameter{Rgb::gray(1)}};
  scene.settings = {.width_px = 8, .height_px = 8, .spp = 256};
  return scene;
}

std::vector<double> means(const Scene& scene, SampleRange range) {
  const RenderSettings& settings = scene.settings();
  const FilmTile tile =
      render(prepare(scene, settings, 2), {0, 0, settings.width_px, settings.height_px}, range, 2);
  std::vector<double> means;
  for (std::size_t i = 0; i < tile.sums.size(); i += 3)
    means.push_back(static_cast<double>(tile.sums[i]) * kFilmUnit / (range.end - range.begin));
  return means;
}

std::vector<double> means(const SceneDescription& scene, std::uint32_t samples) {
  return means(Scene::build(scene, 2).value(), {0, samples});
}

// The scene at a time while the shutter is open, without blur.
SceneDescription still_at(SceneDescription scene, float frame) {
  scene.camera = camera_at(scene.camera, scene.animation.camera, frame);
  scene.camera.shutter_open = scene.camera.shutter_close = 0;
  for (const InstanceMotion& motion : scene.animation.instances)
    std::get<InstanceDescription>(scene.shapes[motion.shape]).to_world = transform_at(motion.steps, frame);
  scene.animation = {};
  return scene;
}

// The mean of images at equally spaced times, each of other samples.
std::vector<double> mean_of_stills(const SceneDescription& scene, std::uint32_t images,
                                   std::uint32_t samples) {
  std::vector<double> sum;
  for (std::uint32_t i = 0; i < images; ++i) {
    const float time = (static_cast<float>(i) + 0.5f) / static_cast<float>(images);
    const Scene still = Scene::build(still_at(scene, time), 2).value();
    const std::vector<double> one = means(still, {samples * i, samples * (i + 1)});
    sum.resize(one.size());
    for (std::size_t p = 0; p < one.size(); ++p) sum[p] += one[p] / images;
  }
  return sum;
}

double greatest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double greatest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) greatest = std::max(greatest, std::abs(a[i] - b[i]));
  return greatest;
}

const QuadDescription kBar{{-0.25f, -2, 0}, {0.5f, 0, 0}, {0, 4, 0}, 0};
const QuadDescription kRod{{-0.9f, -0.15f, 0}, {1.8f, 0, 0}, {0, 0.3f, 0}, 0};

std::vector<MotionStep> shift(float from, float to) {
  return {TranslationMotion{{{0, 1}, {{from, 0, 0}, {to, 0, 0}}}}};
}

// The part of a time and a pixel [x0, x1] that a bar of width 0.5 covers on its way from x = -0.5 to 0.75.
double coverage_of_shift(double x0, double x1) {
  constexpr int kSteps = 20000;
  double covered = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double center = -0.5 + 1.25 * (i + 0.5) / kSteps;
    covered += std::max(0.0, std::min(x1, center + 0.25) - std::max(x0, center - 0.25)) / (x1 - x0);
  }
  return covered / kSteps;
}

void expect_shifting_bar(const SceneDescription& scene, const char* what) {
  const std::vector<double> blurred = means(scene, 1024);
  for (std::size_t x = 0; x < 8; ++x) {
    const double left = -1 + 0.25 * static_cast<double>(x);
    for (std::size_t y = 0; y < 8; ++y)
      EXPECT_NEAR(blurred[8 * y + x], 1 - coverage_of_shift(left, left + 0.25), 0.02)
          << what << ' ' << x << ' ' << y;
  }
}

// By paths, by trees of rays, and by the paths of scenes with media.
void expect_shifting_bar_by_all(SceneDescription scene) {
  expect_shifting_bar(scene, "path");
  scene.settings.integrator = Integrator::kWhitted;
  expect_shifting_bar(scene, "whitted");
  scene.settings.integrator = Integrator::kMis;
  scene.media = {{.name = "fog", .sigma_a = Rgb::gray(1)}};
  scene.materials.push_back(scene.materials[0]);  // of no shape
  scene.materials.back().media.interior = 0;
  expect_shifting_bar(scene, "volume path");
}

TEST(MotionBlur, OfAMovingBarIsTheShareOfTimeThatItCovers) {
  expect_shifting_bar_by_all(silhouette(kBar, shift(-0.5f, 0.75f)));
}

// The bar is out of sight, beside the camera's view.
TEST(MotionBlur, OfAMovingShadowIsTheShareOfTimeThatItCovers) {
  SceneDescription scene = silhouette(kBar, shift(-0.5f, 0.75f));
  scene.animation.instances[0].steps.push_back(translation({-3, 0, 3}));
  scene.environment = {};
  scene.materials.push_back({"white", test::lambert(1)});
  scene.shapes.push_back(QuadDescription{{-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, 1});
  scene.lights = {DirectionalLightDescription{{1, 0, -1}, Rgb::gray(4.44288294f)}};  // pi sqrt(2)
  expect_shifting_bar_by_all(scene);
}

// The bar is behind the camera, which sees a mirror.
TEST(MotionBlur, InAMirrorIsTheShareOfTimeThatIsCovered) {
  SceneDescription scene = silhouette(kBar, shift(-0.5f, 0.75f));
  scene.animation.instances[0].steps.push_back(translation({0, 0, 10}));
  scene.materials.push_back({"mirror", Mirror{{Rgb::gray(1), -1}}});
  scene.shapes.push_back(QuadDescription{{-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, 1});
  expect_shifting_bar_by_all(scene);
}

TEST(MotionBlur, OfAMovingLampIsTheShareOfTimeThatItCovers) {
  SceneDescription scene = silhouette(kBar, shift(-0.5f, 0.75f));
  scene.environment = {};
  scene.materials[0].emission = ColorParameter{Rgb::gray(1)};
  for (const Integrator integrator : {Integrator::kMis, Integrator::kNee, Integrator::kWhitted}) {
    scene.settings.integrator = integrator;
    const std::vector<double> blurred = means(scene, 1024);
    for (std::size_t x = 0; x < 8; ++x) {
      const double left = -1 + 0.25 * static_cast<double>(x);
      EXPECT_NEAR(blurred[x], coverage_of_shift(left, left + 0.25), 0.02) << x;
    }
  }
}

// Shapes that light a floor on their way beside the camera's view.
SceneDescription floor_under(const ShapeDescription& lamp) {
  SceneDescription scene = silhouette(lamp, {TurnMotion{{1, 0, 0}, {{0, 1}, {0, 160}}},
                                             TranslationMotion{{{0, 1}, {{-3, 0, 2}, {-2.5f, 3, 1.5f}}}}});
  scene.environment = {};
  scene.materials[0].emission = ColorParameter{Rgb::gray(1)};
  scene.materials[0].two_sided_emission = false;
  scene.materials.push_back({"white", test::lambert(0.8f)});
  scene.shapes.push_back(QuadDescription{{-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, 1});
  scene.settings.width_px = scene.settings.height_px = 4;
  return scene;
}

double mean_of(const std::vector<double>& pixels) {
  double sum = 0;
  for (const double pixel : pixels) sum += pixel;
  return sum / static_cast<double>(pixels.size());
}

// Light sampling, scattering and their weights know the time.
TEST(MotionBlur, OfMovingLampsLightsAsTheMeanOfStillImages) {
  const ShapeDescription lamps[] = {QuadDescription{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0},
                                    SphereDescription{{0, 0.5f, 0}, 0.8f, 0},
                                    DiskDescription{.center = {0, 0, 0.3f}, .material = 0},
                                    CylinderDescription{.start = {0, 0, -0.5f}, .material = 0}};
  for (const ShapeDescription& lamp : lamps) {
    SceneDescription scene = floor_under(lamp);
    const double expected = mean_of(mean_of_stills(scene, 32, 16));
    EXPECT_GT(expected, 0.001);
    for (const Integrator integrator : {Integrator::kMis, Integrator::kNee, Integrator::kWhitted}) {
      scene.settings.integrator = integrator;
      EXPECT_NEAR(mean_of(means(scene, 512)), expected, 0.02 * expected) << lamp.index();
    }
    scene.settings.integrator = Integrator::kNaive;
    EXPECT_NEAR(mean_of(means(scene, 2048)), expected, 0.08 * expected) << lamp.index();
  }
}

// What moves as the camera does is sharp, so both have one time.
TEST(MotionBlur, LeavesWhatMovesWithTheCameraSharp) {
  SceneDescription scene = silhouette(kBar, shift(0, 0.5f));
  scene.animation.camera.position = {{0, 1}, {{0, 0, 5}, {0.5f, 0, 5}}};
  scene.animation.camera.look_at = {{0, 1}, {{0, 0, 0}, {0.5f, 0, 0}}};
  const std::vector<double> seen = means(scene, 64);
  for (std::size_t p = 0; p < seen.size(); ++p) EXPECT_EQ(seen[p], p % 8 == 3 || p % 8 == 4 ? 0 : 1) << p;
}

TEST(MotionBlur, OfASpinningRodIsTheMeanOfStillImages) {
  const SceneDescription scene =
      silhouette(kRod, {TurnMotion{{0, 0, 1}, {{0, 1}, {10, 170}}}, translation({0.05f, 0, 0})});
  EXPECT_LT(greatest_difference(means(scene, 1024), mean_of_stills(scene, 64, 16)), 0.03);
}

TEST(MotionBlur, OfKeyframedOrientationsIsTheMeanOfStillImages) {
  const SceneDescription scene = silhouette(
      kRod, {ScaleMotion{{{0, 1}, {{1, 1, 1}, {0.3f, 2, 1}}}},
             RotationMotion{{{0, 0.5f, 1},
                             {rotation_quaternion({0, 0, 1}, 0), rotation_quaternion({1, 0, 1}, 100),
                              rotation_quaternion({0, 1, 1}, 40)}}}});
  EXPECT_LT(greatest_difference(means(scene, 1024), mean_of_stills(scene, 64, 16)), 0.03);
}

// With a lens, all decisions of the camera are taken together.
TEST(MotionBlur, OfAMovingCameraWithALensIsTheMeanOfStillImages) {
  SceneDescription scene = silhouette(kRod, shift(0, 0.4f));
  scene.camera.aperture_radius = 0.4f;
  scene.camera.focus_distance = 4;
  scene.animation.camera.position = {{0, 1}, {{0, 0, 5}, {0.2f, 0.5f, 5}}};
  scene.animation.camera.view_height = {{0, 1}, {2, 3}};
  EXPECT_LT(greatest_difference(means(scene, 1024), mean_of_stills(scene, 64, 16)), 0.03);
}

TEST(MotionBlur, LeavesWhatDoesNotMoveToTheBit) {
  SceneDescription moving = silhouette(kBar, shift(-0.8f, -0.5f));
  moving.shapes.push_back(QuadDescription{{0.3f, -0.5f, 0}, {0.4f, 0.1f, 0}, {0, 0.9f, 0}, 0});
  SceneDescription still = still_at(moving, 0);
  const Scene a = Scene::build(moving, 1).value(), b = Scene::build(still, 1).value();
  EXPECT_TRUE(a.has_motion());
  EXPECT_FALSE(b.has_motion());
  const PixelRect right{4, 0, 8, 8};
  EXPECT_EQ(render(prepare(a, a.settings(), 1), right, {0, 16}, 1).sums,
            render(prepare(b, b.settings(), 1), right, {0, 16}, 1).sums);
}

TEST(MotionBlur, IsOffWhereTheShutterIsOpenAndNothingMoves) {
  SceneDescription scene = silhouette(kBar, shift(-0.8f, 0.5f));
  scene.camera.shutter_open = 1;
  scene.camera.shutter_close = 4;
  EXPECT_FALSE(Scene::build(scene, 1).value().has_motion());
  scene.camera.shutter_open = 0.5f;
  EXPECT_TRUE(Scene::build(scene, 1).value().has_motion());
}

// The bar stands still while the shutter is open, but not where it is at the frame.
TEST(MotionBlur, ShowsWhatStandsStillWhereItIsWhileTheShutterIsOpen) {
  SceneDescription scene = silhouette(kBar, shift(-0.8f, 0.5f));
  scene.camera.shutter_open = 1.25f;
  scene.camera.shutter_close = 1.75f;
  EXPECT_EQ(means(scene, 16), means(still_at(scene, 1.25f), 16));
}

// An instant between two frames, of all that would move.
TEST(MotionBlur, OfNoTimeIsTheInstant) {
  SceneDescription scene = silhouette(kRod, {TurnMotion{{0, 0, 1}, {{0, 2}, {0, 180}}}});
  scene.animation.camera.position = {{0, 2}, {{0, 0, 5}, {0.5f, 0.2f, 5}}};
  scene.camera.shutter_open = scene.camera.shutter_close = 0.75f;
  Scene shown = Scene::build(scene, 1).value();
  EXPECT_FALSE(shown.has_motion());
  EXPECT_EQ(means(shown, {0, 8}), means(still_at(scene, 0.75f), 8));
  ASSERT_TRUE(shown.set_frame(1, 1));
  EXPECT_EQ(means(shown, {0, 8}), means(still_at(scene, 1.75f), 8));
  scene.camera.shutter_open = scene.camera.shutter_close = 0;
  EXPECT_EQ(means(scene, 8), means(still_at(scene, 0), 8));
}

// Frame 3 with the shutter of frame 0 moved by three frames.
TEST(MotionBlur, OfAnotherFrameIsThatOfItsTime) {
  SceneDescription scene = silhouette(kRod, {TurnMotion{{0, 0, 1}, {{0, 8}, {0, 720}}}});
  scene.camera.shutter_close = 0.5f;
  scene.animation.camera.position = {{0, 8}, {{0, 0, 5}, {0.5f, 0, 5}}};
  Scene shown = Scene::build(scene, 1).value();
  const std::vector<double> at_first = means(shown, {0, 8});
  ASSERT_TRUE(shown.set_frame(3, 1));
  scene.camera.shutter_open += 3;
  scene.camera.shutter_close += 3;
  const Scene shifted = Scene::build(scene, 1).value();
  EXPECT_EQ(means(shown, {0, 8}), means(shifted, {0, 8}));
  EXPECT_NE(means(shown, {0, 8}), at_first);
  ASSERT_TRUE(shown.set_frame(0, 1));
  EXPECT_EQ(means(shown, {0, 8}), at_first);
}

TEST(MotionBlur, OfASampleDoesNotDependOnOthers) {
  SceneDescription room = test::room();
  room.objects = {{"ball", {SphereDescription{{}, 0.3f, 0}}, {}}};
  room.shapes.push_back(InstanceDescription{0, {}, std::nullopt});
  room.animation.instances = {{static_cast<std::uint32_t>(room.shapes.size()) - 1, shift(-0.5f, 0.5f)}};
  room.camera.shutter_close = 1;
  const Scene scene = Scene::build(room, 1).value();
  const FilmTile whole = render(prepare(scene, scene.settings(), 1), {0, 0, 6, 4}, {0, 8}, 1);
  const FilmTile part = render(prepare(scene, scene.settings(), 2), {2, 1, 3, 2}, {0, 8}, 2);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(part.sums[c], whole.sums[3 * (1 * 6 + 2) + c]);
}

std::string refusal(const SceneDescription& scene) {
  const Result<Scene> built = Scene::build(scene, 1);
  return built ? "" : built.error().message;
}

TEST(MotionBlur, OfWhatCannotBeRenderedIsRefused) {
  const SceneDescription flattened =
      silhouette(kRod, {ScaleMotion{{{0, 0.5f, 1}, {{1, 1, 1}, {1e-30f, 1, 1}, {1, 1, 1}}}}});
  EXPECT_THAT(refusal(flattened), HasSubstr("frame 0, while the shutter is open: shapes[0]: the transform "
                                            "flattens the object"));
  const SceneDescription reflected = silhouette(kRod, {ScaleMotion{{{0, 1}, {{1, 1, 1}, {-1, 1, 1}}}}});
  EXPECT_THAT(refusal(reflected), HasSubstr("flattens the object on its way to a reflection"));
  SceneDescription turned = silhouette(kRod, shift(0, 1));
  turned.animation.camera.up = {{0, 1}, {{0, 1, 0}, {0, -1, 0}}};
  EXPECT_THAT(refusal(turned), HasSubstr("while the shutter is open: camera.up: must not be parallel"));
  SceneDescription meets_look_at = silhouette(kRod, shift(0, 1));
  meets_look_at.animation.camera.position = {{0, 0.51f, 0.52f}, {{0, 0, 5}, {0, 0, 0}, {0, 0, 5}}};
  EXPECT_THAT(refusal(meets_look_at), HasSubstr("while the shutter is open: camera.look_at: must differ"));
  SceneDescription flat_then =
      silhouette(kRod, {ScaleMotion{{{0, 0.5f, 1}, {{1, 1, 1}, {1e-30f, 1, 1}, {1, 1, 1}}}}});
  flat_then.camera.shutter_open = flat_then.camera.shutter_close = 0.5f;
  EXPECT_THAT(refusal(flat_then), HasSubstr("while the shutter is open: shapes[0]: the transform flattens"));
  SceneDescription closes_first = silhouette(kRod, shift(0, 1));
  closes_first.camera.shutter_close = -1;
  EXPECT_THAT(refusal(closes_first), HasSubstr("camera.shutter: must open before it closes"));
}

}  // namespace
}  // namespace tessera::core::integrators
