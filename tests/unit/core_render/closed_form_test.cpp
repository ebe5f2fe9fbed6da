// Scenes whose radiance is known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/integrators/render.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
namespace {

constexpr Integrator kStrategies[] = {Integrator::kNaive, Integrator::kNee, Integrator::kMis};

struct Mean {
  double value = 0, standard_error = 0;
};

// The mean radiance (red channel) of every pixel's first `spp` samples, with the error of that mean.
Mean mean_radiance(const Scene& scene, Integrator integrator, std::uint32_t spp, int side_px = 4) {
  const RenderSettings settings{
      .width_px = side_px, .height_px = side_px, .spp = spp, .integrator = integrator};
  double sum = 0, sum2 = 0;
  const int n = side_px * side_px;
  const FilmTile tile = render(scene, settings, {0, 0, side_px, side_px}, {0, spp}, 2);
  for (int p = 0; p < n; ++p) {
    const double v = static_cast<double>(tile.sums[static_cast<std::size_t>(3 * p)]) * kFilmUnit / spp;
    sum += v;
    sum2 += v * v;
  }
  const double mean = sum / n, variance = std::max(0.0, sum2 / n - mean * mean);
  return {mean, std::sqrt(variance / (n - 1))};
}

// Irradiance of a point from a uniform polygon of unit radiance (Lambert 1760; Arvo 1995, eq. 2.10).
// Corners counter-clockwise seen from the point.
double polygon_irradiance(const std::vector<Vec3>& corners, Vec3 point, Vec3 normal) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = normalize(corners[i] - point), b = normalize(corners[(i + 1) % corners.size()] - point);
    const double angle = std::acos(static_cast<double>(dot(a, b)));
    sum += angle * static_cast<double>(dot(normalize(cross(a, b)), normal));
  }
  return std::fabs(sum) / 2;
}

// A camera that sees almost only the origin, from above and aside.
CameraDescription spot_camera() {
  return {.position = {2, 3, 1}, .look_at = {0, 0, 0}, .up = {0, 1, 0.1f}, .vertical_fov_degrees = 0.01f};
}

struct PolygonCase {
  const char* name;
  std::vector<Vec3> corners;  // a fan of triangles is made of it
};

class PolygonLight : public testing::TestWithParam<PolygonCase> {};

TEST_P(PolygonLight, LightsADiffuseFloorAsLambertsFormulaSays) {
  const std::vector<Vec3>& corners = GetParam().corners;
  test::SceneMaker maker(spot_camera());
  const auto floor = maker.material(test::lambert(0.6f));
  const auto lamp = maker.material(test::lambert(0), Rgb::gray(5));
  maker.add(QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, floor});
  MeshDescription fan;
  fan.positions = corners;
  for (std::uint32_t i = 2; i < corners.size(); ++i) fan.triangles.push_back({0, i - 1, i});
  fan.triangle_materials = {lamp};
  maker.add(fan);
  const Scene scene = maker.build();

  const double expected = 0.6 / 3.14159265358979 * 5 * polygon_irradiance(corners, {0, 0, 0}, {0, 1, 0});
  for (const Integrator integrator : kStrategies) {
    const Mean mean = mean_radiance(scene, integrator, integrator == Integrator::kNaive ? 40000 : 4000);
    EXPECT_NEAR(mean.value, expected, 5 * mean.standard_error + 1e-4 * expected)
        << integrator_name(integrator);
    EXPECT_LT(mean.standard_error, 0.02 * expected) << "too noisy to tell";
  }
}

INSTANTIATE_TEST_SUITE_P(
    ClosedForm, PolygonLight,
    testing::Values(
        PolygonCase{"overhead", {{-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}, {-0.5f, 1, 0.5f}}},
        PolygonCase{"aside", {{0.6f, 0.3f, -0.4f}, {0.8f, 0.9f, -0.3f}, {0.7f, 0.8f, 0.6f}}},
        PolygonCase{"upright", {{-0.9f, 0, -0.5f}, {-0.9f, 0, 0.5f}, {-0.9f, 1, 0.5f}, {-0.9f, 1, -0.5f}}},
        PolygonCase{"pentagon",
                    {{0, 0.8f, 0.9f},
                     {0.5f, 0.7f, 0.5f},
                     {0.3f, 0.6f, 0.1f},
                     {-0.3f, 0.6f, 0.1f},
                     {-0.5f, 0.7f, 0.5f}}},
        PolygonCase{"small", {{-0.2f, 0.5f, 0}, {-0.15f, 0.5f, 0}, {-0.15f, 0.55f, 0.05f}}},
        PolygonCase{"large", {{-40, 9, -40}, {40, 9, -40}, {40, 9, 40}, {-40, 9, 40}}}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

// Inside a sphere that emits Le and reflects rho of what meets it, radiance is Le / (1 - rho) everywhere.
class Furnace : public testing::TestWithParam<float> {};

TEST_P(Furnace, HasTheRadianceOfTheGeometricSeries) {
  const float albedo = GetParam();
  test::SceneMaker maker(
      {.position = {0.2f, 0.1f, 0.3f}, .look_at = {1, 0.4f, 0}, .vertical_fov_degrees = 90});
  maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(test::lambert(albedo), Rgb::gray(0.5f))});
  const Scene scene = maker.build();
  const double expected = 0.5 / (1 - static_cast<double>(albedo));
  for (const Integrator integrator : kStrategies) {
    const Mean mean = mean_radiance(scene, integrator, 2000);
    EXPECT_NEAR(mean.value, expected, 5 * mean.standard_error + 1e-4 * expected)
        << integrator_name(integrator);
    EXPECT_LT(mean.standard_error, 0.02 * expected);
  }
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
    for (const Integrator integrator : kStrategies) {
      const Mean mean = mean_radiance(scene, integrator, 1000);
      EXPECT_NEAR(mean.value, 2, 5 * mean.standard_error + 2e-4) << integrator_name(integrator);
    }
  }
}

// Irradiance from a sphere of radius r whose centre stands at height h above the plane: pi Le (r / h)^2.
TEST(SphereLightOverPlane, MatchesTheFormFactor) {
  test::SceneMaker maker(spot_camera());
  maker.add(QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.material(test::lambert(0.5f))});
  maker.add(SphereDescription{{0, 1.5f, 0}, 0.4f, maker.material(test::lambert(0), Rgb::gray(8))});
  const Scene scene = maker.build();
  const double expected = 0.5 * 8 * (0.4 / 1.5) * (0.4 / 1.5);
  for (const Integrator integrator : kStrategies) {
    const Mean mean = mean_radiance(scene, integrator, integrator == Integrator::kNaive ? 40000 : 4000);
    EXPECT_NEAR(mean.value, expected, 5 * mean.standard_error + 1e-4 * expected)
        << integrator_name(integrator);
    EXPECT_LT(mean.standard_error, 0.02 * expected);
  }
}

// A slab of glass lets (1 - R) / (1 + R) through, all reflections between its faces counted (Stokes 1862).
TEST(GlassSlab, LetsThroughWhatTheGeometricSeriesSays) {
  test::SceneMaker maker({.position = {0, 0, 3}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 0.5f});
  const auto glass = maker.material(Glass{.ior = 1.5f});
  maker.add(QuadDescription{{-5, -5, 0.1f}, {10, 0, 0}, {0, 10, 0}, glass});
  maker.add(QuadDescription{{-5, -5, -0.1f}, {0, 10, 0}, {10, 0, 0}, glass});
  maker.add(
      QuadDescription{{-5, -5, -2}, {10, 0, 0}, {0, 10, 0}, maker.material(test::lambert(0), Rgb::gray(3))});
  const Scene scene = maker.build();
  const double reflectance = 0.04;
  const Mean mean = mean_radiance(scene, Integrator::kMis, 4000);
  EXPECT_NEAR(mean.value, 3 * (1 - reflectance) / (1 + reflectance), 5 * mean.standard_error + 1e-4);
}

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
    return mean_radiance(Scene::build(description, 1).value(), Integrator::kMis, 64, 24);
  };
  const Mean one = brightness(1), scaled = brightness(GetParam());
  // The same random numbers drive both, so that only rounding can tell them apart.
  EXPECT_NEAR(scaled.value, one.value, 0.01 * one.value);
}

INSTANTIATE_TEST_SUITE_P(ClosedForm, Scale, testing::Values(1e-3f, 1e-2f, 10.0f, 1e3f, 1e5f));

}  // namespace
}  // namespace tessera::core
