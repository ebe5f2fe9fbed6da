// SPDX-License-Identifier: Apache-2.0
// Scenes whose radiance is known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/math/elementary.hpp"
#include "core/sampling/sampler.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

using test::expect_radiance;
using test::Mean;
using test::mean_radiance;

// Inside a sphere that emits Le and reflects rho of what meets it, radiance is Le / (1 - rho) everywhere.
class Furnace : public testing::TestWithParam<float> {};

TEST_P(Furnace, HasTheRadianceOfTheGeometricSeries) {
  const float albedo = GetParam();
  test::SceneMaker maker(
      {.position = {0.2f, 0.1f, 0.3f}, .look_at = {1, 0.4f, 0}, .vertical_fov_degrees = 90});
  maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(test::lambert(albedo), Rgb::gray(0.5f))});
  const Scene scene = maker.build();
  const std::uint32_t spp = albedo > 0.9f ? 200 : 500;  // paths have some 1 / (1 - albedo) vertices
  expect_radiance(scene, 0.5 / (1 - static_cast<double>(albedo)), spp);
}

INSTANTIATE_TEST_SUITE_P(ClosedForm, Furnace, testing::Values(0.0f, 0.3f, 0.5f, 0.8f, 0.95f, 0.99f));

// In an even environment, a white body cannot be told from it.
TEST(CappedCylinder, IsInvisibleInAWhiteFurnace) {
  test::SceneMaker maker({.position = {2, 2.5f, 3}, .look_at = {0, 0.5f, 0}, .vertical_fov_degrees = 45});
  const auto white = maker.material(test::lambert(1));
  maker.add(DiskDescription{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 0, false, white});
  maker.add(DiskDescription{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 0.5f, false, white});
  maker.add(CylinderDescription{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}, false, white});
  maker.description().environment = EnvironmentDescription{{Rgb::gray(1)}};
  expect_radiance(maker.build(), 1, 200);
}

// Nearly white scenes have a finite variance: most pixels are near the truth after a few samples.
TEST(NearlyWhiteFurnace, HasItsRadianceInMostPixels) {
  test::SceneMaker maker(
      {.position = {0.2f, 0.1f, 0.3f}, .look_at = {1, 0.4f, 0}, .vertical_fov_degrees = 90});
  maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(test::lambert(0.99f), Rgb::gray(0.5f))});
  const Scene scene = maker.build();
  std::vector<double> ratios;
  const PixelRect all{0, 0, 16, 16};
  const RenderSettings settings{.width_px = all.x1, .height_px = all.y1, .spp = 64};
  const FilmTile tile = render(prepare(scene, settings, 2), all, {0, settings.spp}, 2);
  for (std::size_t i = 0; i < tile.sums.size(); i += 3)
    ratios.push_back(static_cast<double>(tile.sums[i]) * kFilmUnit / settings.spp / 50);
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
                   ratios.end());
  EXPECT_NEAR(ratios[ratios.size() / 2], 1, 0.04);
}

// A coarse ball with interpolated normals.
MeshDescription coarse_ball(Vec3 center, std::uint32_t material) {
  constexpr std::uint32_t kRows = 10, kColumns = 20;
  MeshDescription mesh;
  for (std::uint32_t i = 0; i <= kRows; ++i)
    for (std::uint32_t j = 0; j < kColumns; ++j) {
      const auto [sin_i, cos_i] = sin_cos_turns(static_cast<float>(i) / (2 * kRows));
      const auto [sin_j, cos_j] = sin_cos_turns(static_cast<float>(j) / kColumns);
      const Vec3 n{sin_i * cos_j, cos_i, sin_i * sin_j};
      mesh.positions.push_back(center + n);
      mesh.normals.push_back(n);
      const std::uint32_t a = i * kColumns + j, b = i * kColumns + (j + 1) % kColumns;
      if (i > 0 && i < kRows) mesh.triangles.push_back({a, b, b + kColumns});
      if (i + 1 < kRows) mesh.triangles.push_back({a, b + kColumns, a + kColumns});
    }
  mesh.triangle_materials.assign(mesh.triangles.size(), material);
  return mesh;
}

// Interpolated normals lose no light: a ball that absorbs nothing vanishes in a white furnace.
TEST(WhiteFurnace, InterpolatedNormalsAreInvisible) {
  test::SceneMaker maker({.position = {0, 0, 6}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 13});
  maker.add(coarse_ball({0, 0, 0}, maker.material(test::lambert(1))));
  maker.description().environment = {{Rgb::gray(1)}};
  const Scene scene = maker.build();
  for (const test::Strategy& strategy : test::kStrategies) {
    const Mean mean =
        mean_radiance(scene, {.integrator = strategy.integrator, .heuristic = strategy.heuristic}, 256, 16);
    EXPECT_NEAR(mean.value, 1, 0.003) << strategy.name;
  }
}

// The light of a lamp and of an even sky is the same on flat triangles and on interpolated normals.
TEST(InterpolatedNormals, KeepTheBrightnessOfFlatTriangles) {
  const auto brightness = [](bool flat) {
    test::SceneMaker maker({.position = {0, 3, 9}, .look_at = {0, 0.3f, 0}, .vertical_fov_degrees = 32});
    const auto clay = maker.material(test::lambert(0.7f));
    for (const Vec3 center : {Vec3{-2.2f, 1, 0}, {0, 1, 1}, {2.2f, 1, 0}}) {
      MeshDescription ball = coarse_ball(center, clay);
      if (flat) ball.normals.clear();
      maker.add(ball);
    }
    maker.add(QuadDescription{{-20, 0, 20}, {40, 0, 0}, {0, 0, -40}, maker.material(test::lambert(0.5f))});
    maker.add(SphereDescription{{-6, 9, 5}, 1, maker.material(test::lambert(0), Rgb::gray(60))});
    maker.description().environment = {{Rgb::gray(0.8f)}};
    return mean_radiance(maker.build(), {}, 1024 / test::kSampleDivisor, 24).value;
  };
  const double flat = brightness(true);
  EXPECT_NEAR(brightness(false), flat, (test::kSampleDivisor == 1 ? 0.002 : 0.02) * flat);
}

// A map whose normals have one slope and lean all ways.
Texture rough_map(float slope) {
  constexpr int kSide = 64;
  std::vector<float> texels;
  const float z = 1 / std::sqrt(1 + slope * slope);
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto [s, c] = sin_cos_turns(sampling::Sampler(1, i, 0, 0).pad(0)[0]);
    texels.insert(texels.end(), {slope * z * c / 2 + 0.5f, slope * z * s / 2 + 0.5f, z / 2 + 0.5f});
  }
  return {.image = std::make_shared<TextureImage>(TextureImage{kSide, kSide, std::move(texels)})};
}

// What of a white environment a surface reflects.
double reflected(const MaterialModel& model, float slope, Vec3 from, const test::Strategy& strategy) {
  test::SceneMaker maker({.position = from * 6, .look_at = {0, 0, 0}, .vertical_fov_degrees = 5});
  const auto material = maker.material(model);
  if (slope > 0) {
    maker.description().textures = {rough_map(slope)};
    maker.description().materials[material].normal_map = {0, 1};
  }
  maker.add(QuadDescription{{-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, material});
  maker.description().environment = {{Rgb::gray(1)}};
  return mean_radiance(maker.build(), {.integrator = strategy.integrator, .heuristic = strategy.heuristic},
                       128 / test::kSampleDivisor, 24)
      .value;
}

// Neither do normal maps.
TEST(WhiteFurnace, NormalMapsAreInvisible) {
  for (const test::Strategy& strategy : test::kStrategies)
    for (const float slope : {0.2f, 0.5f, 1.0f})
      for (const Vec3 from : {Vec3{0, 0, 1}, Vec3{0.8f, 0, 0.6f}})
        EXPECT_NEAR(reflected(test::lambert(1), slope, from, strategy), 1,
                    test::kSampleDivisor == 1 ? 0.005 : 0.02)
            << strategy.name << ", slope " << slope;
}

// Glossy surfaces lose no more under a map than without one, as the viewer sees them at other angles.
TEST(WhiteFurnace, NormalMapsKeepWhatMetalsReflect) {
  const MaterialModel metal = CookTorrance{.diffuse = {{}, -1}, .f0 = {Rgb::gray(1), -1}, .roughness = 0.3f};
  const test::Strategy& mis = test::kStrategies[2];
  for (const Vec3 from : {Vec3{0, 0, 1}, Vec3{0.6f, 0, 0.8f}, Vec3{0.8f, 0, 0.6f}})
    EXPECT_NEAR(reflected(metal, 0.5f, from, mis), reflected(metal, 0, from, mis), 0.05);
}

// Objects that absorb nothing vanish in a white furnace: glass and mirrors included.
TEST(WhiteFurnace, LosslessObjectsAreInvisible) {
  for (const MaterialModel& model :
       {MaterialModel{test::lambert(1)}, MaterialModel{Mirror{}}, MaterialModel{Glass{}}}) {
    test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 30});
    maker.add(SphereDescription{{0, 0, 0}, 10, maker.material(test::lambert(0), Rgb::gray(2))});
    maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(model)});
    const Scene scene = maker.build();
    expect_radiance(scene, 2, 1000);
  }
}

// A slab of glass lets (1 - R) / (1 + R) through, all reflections between its faces counted (Stokes 1862).
class GlassSlab : public testing::TestWithParam<std::pair<DielectricFresnel, double>> {};

TEST_P(GlassSlab, LetsThroughWhatTheGeometricSeriesSays) {
  const auto [fresnel, reflectance] = GetParam();
  test::SceneMaker maker({.position = {0, 0, 3}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 0.5f});
  const auto glass = maker.material(Glass{.ior = 1.5f, .fresnel = fresnel});
  maker.add(QuadDescription{{-5, -5, 0.1f}, {10, 0, 0}, {0, 10, 0}, glass});
  maker.add(QuadDescription{{-5, -5, -0.1f}, {0, 10, 0}, {10, 0, 0}, glass});
  maker.add(
      QuadDescription{{-5, -5, -2}, {10, 0, 0}, {0, 10, 0}, maker.material(test::lambert(0), Rgb::gray(3))});
  const Scene scene = maker.build();
  const Mean mean = mean_radiance(scene, {}, 4000);
  EXPECT_NEAR(mean.value, 3 * (1 - reflectance) / (1 + reflectance), 5 * mean.standard_error + 1e-4);
}

INSTANTIATE_TEST_SUITE_P(ClosedForm, GlassSlab,
                         testing::Values(std::pair{DielectricFresnel::kExact, 0.04},
                                         std::pair{DielectricFresnel::kSchlick, 0.04},
                                         std::pair{DielectricFresnel::kNone, 0.0}));

// The closed forms hold at every scale: rays neither stick to surfaces nor leak through them.
class Scale : public testing::TestWithParam<float> {};

TEST_P(Scale, DoesNotChangeRadiance) {
  const auto brightness = [](float scale) {
    SceneDescription description = test::room();
    for (ShapeDescription& shape : description.shapes) {
      if (auto* quad = std::get_if<QuadDescription>(&shape)) {
        quad->corner = quad->corner * scale;
        quad->edge_u = quad->edge_u * scale;
        quad->edge_v = quad->edge_v * scale;
      } else if (auto* sphere = std::get_if<SphereDescription>(&shape)) {
        sphere->center = sphere->center * scale;
        sphere->radius *= scale;
      }
    }
    CameraDescription& camera = description.camera;
    camera.position = camera.position * scale;
    camera.look_at = camera.look_at * scale;
    camera.aperture_radius *= scale;
    return mean_radiance(Scene::build(description, 1).value(), {}, 64, 24);
  };
  const Mean one = brightness(1), scaled = brightness(GetParam());
  // The same random numbers drive both, so that only rounding can tell them apart.
  EXPECT_NEAR(scaled.value, one.value, 0.01 * one.value);
}

INSTANTIATE_TEST_SUITE_P(ClosedForm, Scale, testing::Values(1e-3f, 1e-2f, 10.0f, 1e3f, 1e5f));

}  // namespace
}  // namespace tessera::core::integrators
