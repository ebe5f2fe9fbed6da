// Scenes whose radiance is known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
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
  expect_radiance(scene, 0.5 / (1 - static_cast<double>(albedo)), 500);
}

INSTANTIATE_TEST_SUITE_P(ClosedForm, Furnace, testing::Values(0.0f, 0.3f, 0.5f, 0.8f, 0.95f));

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
}  // namespace tessera::core
