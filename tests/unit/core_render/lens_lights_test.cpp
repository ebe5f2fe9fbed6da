// SPDX-License-Identifier: Apache-2.0
// Lens light sampling: the same expectation as the lens alone, with less noise, for lamps of every shape.
#include "core/integrators/lens_lights.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/film/fixed_point.hpp"
#include "core/film/layout.hpp"
#include "core/integrators/render.hpp"
#include "tests/support/effort.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

constexpr float kFocusDistance = 5, kLensRadius = 0.3f;
constexpr CameraDescription kLens{
    .position = {0, 0, 5}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 20, .aperture_radius = kLensRadius};

// A lamp of about this size at a place.
using LampAt = std::function<ShapeDescription(Vec3 place, float size, std::uint32_t material)>;

// A grid of lamps that fills what the camera sees at the depth z. Each is 1/36 of the lens, seen through a
// point in focus, and all of them together are about 1/5.
test::SceneMaker lamps(const LampAt& lamp, float z = -5, CameraDescription camera = kLens,
                       bool two_sided = true, float sizes_apart = 4) {
  test::SceneMaker maker(camera);
  const float scale = std::fabs(z) / kFocusDistance, size = kLensRadius / 6 * scale,
              spacing = sizes_apart * size;
  const int half = static_cast<int>(1.1f * (5 - z) * 0.18f / spacing) + 1;
  const auto dim = maker.material(test::lambert(0), Rgb::gray(2), two_sided),
             bright = maker.material(test::lambert(0), Rgb::gray(7), two_sided);
  for (int i = -half; i <= half; ++i)
    for (int j = -half; j <= half; ++j)
      maker.add(lamp({static_cast<float>(i) * spacing, static_cast<float>(j) * spacing, z}, size,
                     (i + j) % 3 == 0 ? bright : dim));
  return maker;
}

ShapeDescription ball(Vec3 place, float size, std::uint32_t material) {
  return SphereDescription{place, size, material};
}

// Tilted, and facing the camera.
ShapeDescription panel(Vec3 place, float size, std::uint32_t material) {
  return QuadDescription{place, {size, 0, size / 2}, {size / 3, 1.5f * size, 0}, material};
}

ShapeDescription ring(Vec3 place, float size, std::uint32_t material) {
  return DiskDescription{.center = place,
                         .radius_u = {1.2f * size, 0, size / 2},
                         .radius_v = {0, size, 0},
                         .inner = 0.4f,
                         .material = material};
}

ShapeDescription tube(Vec3 place, float size, std::uint32_t material) {
  return CylinderDescription{.start = place,
                             .axis = {0.7f * size, 1.4f * size, 0.7f * size},
                             .radius_u = {0.4f * size, 0, 0},
                             .radius_v = {0, 0, 0.4f * size},
                             .material = material};
}

ShapeDescription tetrahedron(Vec3 place, float size, std::uint32_t material) {
  MeshDescription mesh;
  for (const Vec3 corner : {Vec3{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}})
    mesh.positions.push_back(place + corner * (0.4f * size));
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  mesh.triangle_materials.assign(4, material);
  return mesh;
}

SceneDescription balls() {
  return lamps(ball).description();
}

SceneDescription balls_before_the_focus() {
  return lamps(ball, 2.5f).description();
}

SceneDescription panels_with_dark_backs() {
  return lamps(panel, -5, kLens, false).description();
}

SceneDescription panels_before_the_focus() {
  return lamps(panel, 2.5f, kLens, false).description();
}

SceneDescription rings() {
  return lamps(ring).description();
}

SceneDescription tubes() {
  return lamps(tube, 2.5f).description();
}

SceneDescription tetrahedra() {
  return lamps(tetrahedron, -5, kLens, false).description();
}

// Behind a black ball and a sheet that is half transparent; textured, and partly transparent themselves.
SceneDescription veiled_balls() {
  SceneDescription scene = lamps(ball, 2.5f).description();
  const TextureImage spots{2, 2, std::vector<float>{0.2f, 0.5f, 1, 1, 1, 1, 0.6f, 0.6f, 0.6f, 0.3f, 0, 0}};
  scene.textures = {{.image = std::make_shared<TextureImage>(spots), .scale = {2, 2}}};
  scene.materials[0].emission = {Rgb::gray(5), 0};
  scene.materials[1].opacity = {1, 0};
  scene.materials.push_back({.name = "black", .model = test::lambert(0)});
  scene.materials.push_back({.name = "sheet", .model = test::lambert(0), .opacity = 0.5f});
  scene.shapes.emplace_back(SphereDescription{{0.1f, 0.1f, 3.5f}, 0.1f, 2});
  scene.shapes.emplace_back(QuadDescription{{-0.2f, -0.4f, 4}, {0.3f, 0, 0.1f}, {0, 0.8f, 0}, 3});
  return scene;
}

SceneDescription textured_balls() {
  SceneDescription scene = balls_before_the_focus();
  const TextureImage spots{2, 2, std::vector<float>{0.2f, 0.5f, 1, 1, 1, 1, 0, 0, 0, 0.3f, 0, 0}};
  scene.textures = {{.image = std::make_shared<TextureImage>(spots)}};
  scene.materials[0].emission = scene.materials[1].emission = {Rgb::gray(5), 0};
  return scene;
}

SceneDescription through_blades() {
  CameraDescription camera = kLens;
  camera.aperture_radius = 0.4f;
  camera.aperture_blades = 5;
  camera.aperture_rotation_degrees = 20;
  camera.lens_shift = {0.1f, -0.2f};
  camera.mirrored = true;
  SceneDescription scene = lamps(ball, -5, camera).description();
  scene.settings.filter = default_filter(FilterKind::kGaussian);
  return scene;
}

SceneDescription in_parallel() {
  CameraDescription camera = kLens;
  camera.type = CameraType::kOrthographic;
  camera.view_height = 2;
  return lamps(ball, -5, camera).description();
}

// Lamps of instances, of which one moves, seen by a camera that moves, too.
SceneDescription in_motion() {
  CameraDescription camera = kLens;
  camera.shutter_close = 1;
  SceneDescription scene = lamps(ball, -5, camera, true, 6).description();
  scene.objects = {{"lamps", scene.shapes, {}}};
  scene.shapes = {InstanceDescription{0, {}, std::nullopt},
                  InstanceDescription{0, translation({0.1f, 0.1f, -1}), std::nullopt}};
  scene.animation.instances = {{0, {TranslationMotion{{{0, 1}, {{0, 0, 0}, {0.3f, 0.1f, 0.4f}}}}}}};
  scene.animation.camera.position = {{0, 1}, {{0, 0, 5}, {0.2f, 0.1f, 5}}};
  return scene;
}

struct LensCase {
  const char* name;
  SceneDescription (*describe)();
};

struct Estimate {
  double mean = 0, error2 = 0;
};

// The sum of an image, from several seeds.
Estimate estimate(const Scene& scene, Integrator integrator, Heuristic heuristic) {
  constexpr int kRuns = 16, kSide = 8;
  const std::uint32_t spp = std::max(8u, 128 / test::kEffortDivisor);
  RenderSettings settings = scene.settings();
  settings.width_px = settings.height_px = kSide;
  settings.integrator = integrator;
  settings.heuristic = heuristic;
  double sum = 0, sum2 = 0;
  for (int run = 0; run < kRuns; ++run) {
    settings.seed = static_cast<std::uint64_t>(run) + 1;
    const FilmTile tile = render(prepare(scene, settings, 1), {0, 0, kSide, kSide}, {0, spp}, 1);
    double total = 0;
    for (const std::uint64_t word : tile.sums) total += static_cast<double>(word) * kFilmUnit / spp;
    sum += total;
    sum2 += total * total;
  }
  const double mean = sum / kRuns;
  return {mean, std::max(0.0, sum2 / kRuns - mean * mean) / (kRuns - 1)};
}

class LensLightSampling : public testing::TestWithParam<LensCase> {};

INSTANTIATE_TEST_SUITE_P(
    Scenes, LensLightSampling,
    testing::Values(LensCase{"balls", balls}, LensCase{"balls_before_the_focus", balls_before_the_focus},
                    LensCase{"panels_with_dark_backs", panels_with_dark_backs},
                    LensCase{"panels_before_the_focus", panels_before_the_focus}, LensCase{"rings", rings},
                    LensCase{"tubes", tubes}, LensCase{"tetrahedra", tetrahedra},
                    LensCase{"veiled_balls", veiled_balls}, LensCase{"textured_balls", textured_balls},
                    LensCase{"through_blades", through_blades}, LensCase{"in_parallel", in_parallel},
                    LensCase{"in_motion", in_motion}),
    [](const auto& of) { return std::string(of.param.name); });

// `naive` leaves lamps to the lens.
TEST_P(LensLightSampling, HasTheMeanOfTheLensAloneAndLessNoise) {
  const Scene scene = Scene::build(GetParam().describe(), 2).value();
  ASSERT_NE(prepare(scene, scene.settings(), 1).lens_lights(), nullptr);
  const Estimate lens = estimate(scene, Integrator::kNaive, Heuristic::kBalance);
  ASSERT_LT(std::sqrt(lens.error2), 0.02 * test::kEffortDivisor * lens.mean) << "too noisy to tell";
  for (const Heuristic heuristic : {Heuristic::kBalance, Heuristic::kPower}) {
    const Estimate both = estimate(scene, Integrator::kMis, heuristic);
    EXPECT_NEAR(both.mean, lens.mean, 5 * std::sqrt(both.error2 + lens.error2)) << heuristic_name(heuristic);
    EXPECT_LT(both.error2, lens.error2) << heuristic_name(heuristic);
  }
}

SceneDescription one_ball(CameraDescription camera, float z, float radius) {
  test::SceneMaker maker(camera);
  maker.add(SphereDescription{{0, 0, z}, radius, maker.material(test::lambert(0), Rgb::gray(3))});
  return maker.description();
}

// The rays that hit a ball fill a cone at the focus, and the part of the lens that they come from is a disk.
TEST(LensLights, OfOneBallAreItsShareOfTheLens) {
  CameraDescription camera = kLens;
  camera.vertical_fov_degrees = 0.01f;
  constexpr float kRadius = 0.06f, kDistance = 5;
  constexpr float kSine = kRadius / kDistance, kReach = kFocusDistance / kLensRadius;
  const double share = static_cast<double>(kSine * kSine / (1 - kSine * kSine) * kReach * kReach);
  const Scene scene = Scene::build(one_ball(camera, -kDistance, kRadius), 1).value();
  for (const Heuristic heuristic : {Heuristic::kBalance, Heuristic::kPower}) {
    const test::Mean mean = test::mean_radiance(scene, {.heuristic = heuristic}, 1024);
    EXPECT_NEAR(mean.value, 3 * share, 5 * mean.standard_error + 1e-4 * share) << heuristic_name(heuristic);
    EXPECT_LT(mean.standard_error, 3e-3 * 3 * share) << heuristic_name(heuristic);
  }
}

// Lamps over a floor that reflects their light, and among things in focus.
SceneDescription lamps_over_a_floor() {
  SceneDescription scene = balls();
  scene.materials.push_back({.name = "floor", .model = test::lambert(0.5f)});
  scene.materials.push_back({.name = "sheet", .model = test::lambert(0.3f), .opacity = 0.6f});
  scene.materials[0].light_group = "dim";
  scene.materials[1].light_group = "bright";
  scene.shapes.emplace_back(QuadDescription{{-9, -0.6f, 9}, {18, 0, 0}, {0, 0, -18}, 2});
  scene.shapes.emplace_back(SphereDescription{{0.2f, -0.3f, 0}, 0.3f, 2});
  scene.shapes.emplace_back(QuadDescription{{-0.5f, -0.3f, 1}, {0.4f, 0, 0}, {0, 0.6f, 0}, 3});
  scene.settings = {.width_px = 40, .height_px = 24, .spp = 12};
  return scene;
}

TEST(LensLights, DoNotDependOnHowARenderIsCut) {
  const Scene scene = Scene::build(lamps_over_a_floor(), 2).value();
  const RenderSettings& settings = scene.settings();
  const RenderPlan plan = prepare(scene, settings, 2);
  ASSERT_NE(plan.lens_lights(), nullptr);
  const TileGrid grid(settings.width_px, settings.height_px, 16);
  Film whole(grid), pieces(grid);
  const FilmTile one = render(plan, settings.window(), {0, settings.spp}, 1);
  whole.add(one);
  EXPECT_EQ(render(prepare(scene, settings, 1), settings.window(), {0, settings.spp}, 3).sums, one.sums);
  for (int tile = grid.tile_count() - 1; tile >= 0; --tile)
    for (const SampleRange range : {SampleRange{5, 12}, {0, 1}, {1, 5}})
      pieces.add(render(plan, grid.rect(tile), range, 1 + tile % 3));
  EXPECT_TRUE(pieces == whole);
}

TEST(LensLights, OfOneSampleCanBeReplayed) {
  const Scene scene = Scene::build(balls(), 2).value();
  const RenderPlan plan = prepare(scene, {.width_px = 8, .height_px = 8}, 1);
  bool lit = false;
  for (std::uint32_t s = 0; s < 8; ++s) {
    const FilmTile tile = render(plan, {3, 3, 4, 4}, {s, s + 1}, 1);
    const double replayed = static_cast<double>(render_sample(plan, {3, 3, s}).r);
    EXPECT_NEAR(static_cast<double>(tile.sums[0]) * kFilmUnit, replayed, kFilmUnit);
    lit = lit || replayed > 0;
  }
  EXPECT_TRUE(lit);
}

// Without scattering, the layer of emission and the light groups hold what the lens finds.
TEST(LensLights, AreInTheLayerOfEmissionAndInTheirGroup) {
  SceneDescription description = lamps_over_a_floor();
  for (Material& material : description.materials) material.model = test::lambert(0);
  const Scene scene = Scene::build(description, 2).value();
  RenderSettings settings = scene.settings();
  settings.layers = LayerSet{}.with(Layer::kEmission).with(Layer::kIndirect);
  settings.layers.groups = {"bright", "dim"};
  const FilmTile tile = render(prepare(scene, settings, 2), settings.window(), {0, settings.spp}, 2);
  const auto sum_of_plane = [&](std::size_t plane) {
    double sum = 0;
    for (const std::uint64_t word : tile.planes[plane]) sum += static_cast<double>(word) * kFilmUnit;
    return sum;
  };
  double beauty = 0;
  for (std::size_t i = 0; i < tile.sums.size(); i += 3)
    beauty += static_cast<double>(tile.sums[i]) * kFilmUnit;
  ASSERT_GT(beauty, 0);
  EXPECT_NEAR(sum_of_plane(first_plane(settings.layers, Layer::kEmission)), beauty, 1e-5 * beauty);
  EXPECT_EQ(sum_of_plane(first_plane(settings.layers, Layer::kIndirect)), 0);
  const double bright = sum_of_plane(first_group_plane(settings.layers, 0)),
               dim = sum_of_plane(first_group_plane(settings.layers, 1));
  EXPECT_NEAR(bright + dim, beauty, 1e-5 * beauty);
  EXPECT_GT(bright, 0.1 * beauty);
  EXPECT_GT(dim, 0.1 * beauty);
}

bool has_lens_lights(const SceneDescription& description, Integrator integrator = Integrator::kMis) {
  const Scene scene = Scene::build(description, 1).value();
  RenderSettings settings = scene.settings();
  settings.integrator = integrator;
  return prepare(scene, settings, 1).lens_lights() != nullptr;
}

TEST(LensLights, AreSmallLampsOutOfFocusBeforeALens) {
  EXPECT_TRUE(has_lens_lights(one_ball(kLens, -5, 0.05f)));
  EXPECT_TRUE(has_lens_lights(one_ball(kLens, 2.5f, 0.03f)));
  EXPECT_FALSE(has_lens_lights(one_ball(kLens, -5, 0.2f))) << "it is large";
  EXPECT_FALSE(has_lens_lights(one_ball(kLens, -0.1f, 0.05f))) << "it is almost in focus";
  EXPECT_FALSE(has_lens_lights(one_ball(kLens, 0, 0.05f))) << "it is in focus";
  EXPECT_FALSE(has_lens_lights(one_ball(kLens, 7, 0.05f))) << "it is behind the camera";
  CameraDescription other = kLens;
  other.aperture_radius = 0;
  EXPECT_FALSE(has_lens_lights(one_ball(other, -5, 0.05f))) << "a pinhole";
  other = kLens;
  other.type = CameraType::kPanoramic;
  EXPECT_FALSE(has_lens_lights(one_ball(other, -5, 0.05f)));
}

TEST(LensLights, AreThoseOfMisWithoutMedia) {
  for (const Integrator integrator : {Integrator::kNaive, Integrator::kNee, Integrator::kWhitted})
    EXPECT_FALSE(has_lens_lights(balls(), integrator));
  SceneDescription fog = balls();
  fog.media = {{.sigma_a = Rgb::gray(0.05f), .sigma_s = Rgb::gray(0.2f)}};
  fog.camera_medium = 0;
  EXPECT_FALSE(has_lens_lights(fog));
}

// Scenes that none of their lamps profits from keep their bytes: other lamps are not weighed.
TEST(LensLights, LeaveALampInFocusToTheLens) {
  const auto sums = [](const SceneDescription& description) {
    const Scene scene = Scene::build(description, 1).value();
    return render(prepare(scene, {.width_px = 8, .height_px = 8}, 1), {0, 0, 8, 8}, {0, 16}, 1).sums;
  };
  SceneDescription in_focus = one_ball(kLens, 0, 0.1f), beside = in_focus;
  beside.shapes.emplace_back(SphereDescription{{50, 0, -5}, 0.05f, 0});  // out of sight
  ASSERT_TRUE(has_lens_lights(beside));
  EXPECT_EQ(sums(in_focus), sums(beside));
}

}  // namespace
}  // namespace tessera::core::integrators
