// SPDX-License-Identifier: Apache-2.0
// What each kind of light does to a diffuse surface, against closed forms: every strategy finds it.
#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
namespace {

constexpr float kAlbedo = 0.6f;

using test::expect_radiance;

// A camera that sees almost only the origin, from above and aside, and a diffuse square there that faces up.
test::SceneMaker lit_square() {
  test::SceneMaker maker(
      {.position = {2, 3, 1}, .look_at = {0, 0, 0}, .up = {0, 1, 0.1f}, .vertical_fov_degrees = 0.01f});
  maker.add(QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.material(test::lambert(kAlbedo))});
  return maker;
}

// The radiance of the square under an irradiance.
double reflected(double irradiance) {
  return static_cast<double>(kAlbedo) / std::numbers::pi * irradiance;
}

// What of a polygon is above the ground (Sutherland and Hodgman 1974).
std::vector<Vec3> above_ground(const std::vector<Vec3>& corners) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i], b = corners[(i + 1) % corners.size()];
    if (a.y > 0) kept.push_back(a);
    if ((a.y > 0) != (b.y > 0)) kept.push_back(a + (b - a) * (a.y / (a.y - b.y)));
  }
  return kept;
}

// Irradiance of the origin, facing up, from a uniform polygon of unit radiance (Lambert 1760; Arvo 1995,
// eq. 2.10).
double polygon_irradiance(const std::vector<Vec3>& all_corners) {
  const std::vector<Vec3> corners = above_ground(all_corners);
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = normalize(corners[i]), b = normalize(corners[(i + 1) % corners.size()]);
    const double angle = std::acos(static_cast<double>(dot(a, b)));
    if (angle > 0) sum += angle * static_cast<double>(normalize(cross(a, b)).y);
  }
  return std::fabs(sum) / 2;
}

struct PolygonCase {
  const char* name;
  std::vector<Vec3> corners;
  bool quad = false;  // a parallelogram, as one shape; else a fan of triangles
};

class PolygonLight : public testing::TestWithParam<PolygonCase> {};

TEST_P(PolygonLight, LightsADiffuseFloorAsLambertsFormulaSays) {
  const std::vector<Vec3>& c = GetParam().corners;
  test::SceneMaker maker = lit_square();
  const auto lamp = maker.material(test::lambert(0), Rgb::gray(5));
  if (GetParam().quad) {
    maker.add(QuadDescription{c[0], c[1] - c[0], c[3] - c[0], lamp});
  } else {
    MeshDescription fan;
    fan.positions = c;
    for (std::uint32_t i = 2; i < c.size(); ++i) fan.triangles.push_back({0, i - 1, i});
    fan.triangle_materials = {lamp};
    maker.add(fan);
  }
  expect_radiance(maker.build(), reflected(5 * polygon_irradiance(c)));
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
        PolygonCase{"large", {{-40, 9, -40}, {40, 9, -40}, {40, 9, 40}, {-40, 9, 40}}},
        PolygonCase{"needle", {{-0.9f, 0.7f, -0.2f}, {0.9f, 0.8f, -0.1f}, {0.8f, 0.9f, -0.15f}}},
        PolygonCase{"half_below", {{-0.8f, -0.5f, -0.9f}, {-0.8f, 1.2f, -0.6f}, {-0.8f, 0.2f, 0.9f}}},
        PolygonCase{"tip_above", {{0.3f, 0.6f, -0.7f}, {-0.9f, -1.4f, -0.8f}, {0.9f, -1.2f, -0.9f}}},
        PolygonCase{
            "quad_overhead", {{-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}, {-0.5f, 1, 0.5f}}, true},
        PolygonCase{"quad_slanted",
                    {{-0.7f, 0.4f, -0.6f}, {0.3f, 0.6f, -0.8f}, {0.5f, 1.3f, -0.4f}, {-0.5f, 1.1f, -0.2f}},
                    true},
        PolygonCase{"quad_through_the_ground",
                    {{-0.8f, -1, -0.5f}, {-0.8f, -1, 0.7f}, {-0.6f, 0.9f, 0.7f}, {-0.6f, 0.9f, -0.5f}},
                    true},
        PolygonCase{"quad_edge_on",
                    {{0.3f, 0.05f, -1}, {1.3f, 0.05f, -1}, {1.3f, 0.9f, -0.8f}, {0.3f, 0.9f, -0.8f}},
                    true}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

// The form factor of a sphere seen from a surface element, also where the horizon cuts it (Snyder 1996).
// `distance` is that of the centre in radii.
double sphere_form_factor(double distance, double cos_theta) {
  const double h2 = distance * distance, k = 1 - h2 * cos_theta * cos_theta;
  if (k <= 0) return std::max(0.0, cos_theta) / h2;
  const double rim = std::acos(-cos_theta * std::sqrt((h2 - 1) / (1 - cos_theta * cos_theta)));
  return ((cos_theta * rim - std::sqrt(k * (h2 - 1))) / h2 + std::atan(std::sqrt(k / (h2 - 1)))) /
         std::numbers::pi;
}

struct SphereCase {
  const char* name;
  Vec3 center;
  float radius;
};

class SphereLightOverPlane : public testing::TestWithParam<SphereCase> {};

TEST_P(SphereLightOverPlane, MatchesTheFormFactor) {
  const auto& [name, center, radius] = GetParam();
  test::SceneMaker maker = lit_square();
  maker.add(SphereDescription{center, radius, maker.material(test::lambert(0), Rgb::gray(8))});
  const double distance = static_cast<double>(length(center));
  const double form_factor =
      sphere_form_factor(distance / static_cast<double>(radius), static_cast<double>(center.y) / distance);
  expect_radiance(maker.build(), reflected(8 * std::numbers::pi * form_factor));
}

INSTANTIATE_TEST_SUITE_P(ClosedForm, SphereLightOverPlane,
                         testing::Values(SphereCase{"overhead", {0, 1.5f, 0}, 0.4f},
                                         SphereCase{"tilted", {-0.9f, 0.9f, 0.4f}, 0.5f},
                                         SphereCase{"low", {0, 0.5f, -1.1f}, 0.45f},
                                         SphereCase{"on_the_horizon", {0, 0, -1.2f}, 0.8f},
                                         SphereCase{"mostly_below", {0.2f, -0.2f, -1.2f}, 0.9f}),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

// A disk overhead of radius r at height h has the form factor r^2 / (r^2 + h^2) (Howell 2010, B-12).
TEST(DiskLightOverPlane, MatchesTheFormFactor) {
  for (const float inner : {0.0f, 0.7f}) {
    test::SceneMaker maker = lit_square();
    const auto lamp = maker.material(test::lambert(0), Rgb::gray(6), false);
    maker.add(DiskDescription{{0, 1.5f, 0}, {0.8f, 0, 0}, {0, 0, 0.8f}, inner, false, lamp});
    const auto factor = [](double r2) { return r2 / (r2 + 1.5 * 1.5); };
    const double hole = 0.8 * static_cast<double>(inner);
    expect_radiance(maker.build(), reflected(6 * std::numbers::pi * (factor(0.64) - factor(hole * hole))),
                    1000);
  }
}

// Irradiance of the origin, facing up, from one side of a cylinder of unit radiance. A convex surface hides
// no point whose outside is turned to the origin.
double cylinder_irradiance(const CylinderDescription& c) {
  constexpr int kSteps = 300;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double angle = 2 * std::numbers::pi * (i + 0.5) / kSteps;
      const Vec3d u(c.radius_u), v(c.radius_v), axis(c.axis);
      const Vec3d p = Vec3d(c.start) + (j + 0.5) / kSteps * axis + std::cos(angle) * u + std::sin(angle) * v;
      const Vec3d area = cross(std::cos(angle) * v - std::sin(angle) * u, axis);
      const double d2 = dot(p, p), facing = -dot(area, p);
      if (facing > 0 && p.y > 0) sum += facing * p.y / (d2 * d2);
    }
  return sum * 2 * std::numbers::pi / (double{kSteps} * kSteps);
}

TEST(CylinderLightOverPlane, MatchesItsIntegral) {
  for (const bool elliptic : {false, true}) {
    test::SceneMaker maker = lit_square();
    CylinderDescription lamp{{-0.3f, 0.8f, -0.4f}, {0.5f, 0.2f, 0.6f}, {}, {}, false, 0};
    lamp.radius_u = 0.2f * normalize(cross(lamp.axis, {0, 1, 0}));
    lamp.radius_v = (elliptic ? 2.0f : 1.0f) * 0.2f * normalize(cross(lamp.axis, lamp.radius_u));
    lamp.material = maker.material(test::lambert(0), Rgb::gray(8), false);
    maker.add(lamp);
    expect_radiance(maker.build(), reflected(8 * cylinder_irradiance(lamp)), 600);
  }
}

// Unit shapes in instances; where the map reflects, the front stays outside.
TEST(DiskLightOverPlane, IsTheSameInInstances) {
  for (const bool reflects : {false, true}) {
    test::SceneMaker maker = lit_square();
    const auto lamp = maker.material(test::lambert(0), Rgb::gray(6), false);
    maker.description().objects = {{"lamp", {DiskDescription{.material = lamp}}, {}}};
    const Vec3 u{0.8f, 0, 0}, v{0, 0, 0.8f};
    maker.add(
        InstanceDescription{0, {reflects ? v : u, reflects ? u : v, {0, -2, 0}, {0, 1.5f, 0}}, std::nullopt});
    expect_radiance(maker.build(), reflected(6 * std::numbers::pi * 0.64 / (0.64 + 2.25)), 600);
  }
}

TEST(CylinderLightOverPlane, IsTheSameInInstances) {
  for (const bool reflects : {false, true}) {
    test::SceneMaker maker = lit_square();
    const CylinderDescription shown{
        {-0.3f, 0.8f, -0.4f}, {0.5f, 0.2f, 0.6f}, {0.2f, 0.1f, 0}, {0, 0.3f, -0.1f}};
    const auto lamp = maker.material(test::lambert(0), Rgb::gray(8), false);
    maker.description().objects = {{"lamp", {CylinderDescription{.material = lamp}}, {}}};
    const Vec3 u = shown.radius_u, v = shown.radius_v;
    maker.add(
        InstanceDescription{0, {reflects ? v : u, reflects ? u : v, shown.axis, shown.start}, std::nullopt});
    const double irradiance = cylinder_irradiance(shown);
    ASSERT_GT(irradiance, 0.01);
    expect_radiance(maker.build(), reflected(8 * irradiance), 600);
  }
}

TEST(TexturedLight, LightsLikeTheMeanOfItsTextureWhereItIsFar) {
  test::SceneMaker maker = lit_square();
  const TextureImage image{2, 1, std::vector<float>{4, 0, 0, 12, 0, 0}};
  maker.description().textures = {{.image = std::make_shared<TextureImage>(image)}};
  const auto lamp = maker.material(test::lambert(0));
  maker.description().materials[lamp].emission = {Rgb::gray(2), 0};
  maker.add(QuadDescription{{-2, 40, -2}, {4, 0, 0}, {0, 0, 4}, lamp});
  const Scene scene = maker.build();
  const double expected =
      reflected(2 * 8 * polygon_irradiance({{-2, 40, -2}, {2, 40, -2}, {2, 40, 2}, {-2, 40, 2}}));
  for (const Integrator integrator : {Integrator::kNee, Integrator::kMis}) {
    const test::Mean mean = test::mean_radiance(scene, {.integrator = integrator}, 4000);
    EXPECT_NEAR(mean.value, expected, 5 * mean.standard_error + 2e-3 * expected);
  }
}

// Each half of a screen lights as a lamp of its own would: sampling and looking see the same image on it.
TEST(TexturedLight, ShinesFromWhereItsTextureIsBright) {
  const auto screen = [](Rgb left, Rgb right, auto add_shapes) {
    test::SceneMaker maker = lit_square();
    std::vector<float> texels;
    for (int i = 0; i < 64; ++i)
      for (int c = 0; c < 3; ++c) texels.push_back((i < 32 ? left : right)[c]);
    maker.description().textures = {
        {.image = std::make_shared<TextureImage>(64, 1, std::move(texels)), .wrap = Wrap::kClamp}};
    const auto lamp = maker.material(test::lambert(0));
    maker.description().materials[lamp].emission = {Rgb::gray(1), 0};
    add_shapes(maker, lamp);
    return maker.build();
  };
  const double left =
      polygon_irradiance({{-1, 0.4f, -0.8f}, {0, 0.4f, -0.8f}, {0, 1, -0.8f}, {-1, 1, -0.8f}});
  const double right =
      polygon_irradiance({{0, 0.4f, -0.8f}, {0.7f, 0.4f, -0.8f}, {0.7f, 1, -0.8f}, {0, 1, -0.8f}});
  // The texture's middle lies at x = 0.
  const auto quad = [](test::SceneMaker& maker, std::uint32_t lamp) {
    maker.description().textures[0].scale = {1.7f / 2, 1};
    maker.add(QuadDescription{{-1, 0.4f, -0.8f}, {1.7f, 0, 0}, {0, 0.6f, 0}, lamp});
  };
  const auto mesh = [](test::SceneMaker& maker, std::uint32_t lamp) {
    maker.add(MeshDescription{
        .positions = {{-1, 0.4f, -0.8f}, {0.7f, 0.4f, -0.8f}, {0.7f, 1, -0.8f}, {-1, 1, -0.8f}},
        .normals = {},
        .uvs = {{0, 0}, {0.85f, 0}, {0.85f, 1}, {0, 1}},
        .triangles = {{0, 1, 2}, {0, 2, 3}},
        .triangle_materials = {lamp}});
  };
  // The texture is interpolated across one texel in the middle, which weighs next to nothing.
  expect_radiance(screen({9, 0, 0}, {1, 0, 0}, quad), reflected(9 * left + right));
  expect_radiance(screen({9, 0, 0}, {1, 0, 0}, mesh), reflected(9 * left + right));
}

Scene square_under(LightDescription light) {
  test::SceneMaker maker = lit_square();
  maker.description().lights = {std::move(light)};
  return maker.build();
}

TEST(PointLight, FallsOffWithTheSquareOfTheDistanceAndTheCosine) {
  for (const Vec3 p : {Vec3{0, 2, 0}, Vec3{0, 4, 0}, Vec3{-1, 1, 0.5f}, Vec3{0.2f, 0.01f, 0}}) {
    const double d2 = static_cast<double>(length_squared(p)),
                 cosine = static_cast<double>(p.y) / std::sqrt(d2);
    expect_radiance(square_under(PointLightDescription{p, Rgb::gray(7)}), reflected(7 * cosine / d2), 64);
  }
  EXPECT_EQ(test::mean_radiance(square_under(PointLightDescription{{0, -1, 0}, Rgb::gray(7)}), {}, 64).value,
            0);
}

TEST(SpotLight, FallsOffFromItsInnerToItsOuterCone) {
  // From straight above, the axis at an angle from the vertical: 20 degrees of 30 are in full light, and half
  // way in the cosine there is half of the light.
  const auto from_axis = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return square_under(SpotLightDescription{
        {0, 2, 0}, {static_cast<float>(2 * std::tan(angle)), 0, 0}, Rgb::gray(7), 60, 1.0f / 3});
  };
  const double full = reflected(7.0 / 4),
               half = (std::cos(std::numbers::pi / 9) + std::cos(std::numbers::pi / 6)) / 2;
  for (const double degrees : {0.0, 15.0, 19.9}) expect_radiance(from_axis(degrees), full, 64);
  expect_radiance(from_axis(std::acos(half) * 180 / std::numbers::pi), full / 2, 64);
  EXPECT_EQ(test::mean_radiance(from_axis(30.1), {}, 64).value, 0);
}

TEST(DirectionalLight, FollowsTheCosineWhateverTheDistance) {
  for (const Vec3 way : {Vec3{0, -1, 0}, Vec3{3, -4, 0}, Vec3{0, -1, 20}}) {
    const double cosine = static_cast<double>(-way.y / length(way));
    expect_radiance(square_under(DirectionalLightDescription{way, Rgb::gray(3)}), reflected(3 * cosine), 64);
  }
  EXPECT_EQ(
      test::mean_radiance(square_under(DirectionalLightDescription{{0, 1, 0}, Rgb::gray(3)}), {}, 64).value,
      0);
}

TEST(DeltaLights, AddUp) {
  test::SceneMaker maker = lit_square();
  maker.description().lights = {PointLightDescription{{0, 2, 0}, Rgb::gray(4)},
                                PointLightDescription{{0, 1, 0}, Rgb::gray(1)},
                                DirectionalLightDescription{{3, -4, 0}, Rgb::gray(2)}};
  maker.description().environment = {{Rgb::gray(0.5f)}};
  maker.add(SphereDescription{{0, 3, 0}, 0.3f, maker.material(test::lambert(0), Rgb::gray(20))});
  // The lamp hides as much of the environment as it fills.
  const double lamp = std::numbers::pi * 0.01;
  expect_radiance(maker.build(), reflected(1 + 1 + 0.8 * 2 + 20 * lamp + 0.5 * (std::numbers::pi - lamp)),
                  3000);
}

// A convex object that is lit by the same radiance from everywhere reflects its albedo of it, whatever its
// shape; a white one vanishes.
TEST(ConstantEnvironment, IsReflectedByConvexObjects) {
  for (const float albedo : {0.3f, 1.0f}) {
    test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 20});
    maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(test::lambert(albedo))});
    maker.description().environment = {{Rgb::gray(3)}};
    expect_radiance(maker.build(), 3 * static_cast<double>(albedo), 2000);
  }
}

TEST(ConstantEnvironment, IsSeenWhereNothingElseIsAndThroughLosslessObjects) {
  for (const MaterialModel& model : {MaterialModel{Mirror{}}, MaterialModel{Glass{}}}) {
    test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 50});
    maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(model)});
    maker.description().environment = {{Rgb::gray(3)}};
    expect_radiance(maker.build(), 3, 1000);
  }
}

// Uneven and coarse, with a bright texel at a pole and one beside black ones.
std::shared_ptr<const TextureImage> surroundings() {
  std::vector<float> texels(8 * 4 * 3, 0.0f);
  for (std::size_t i = 0; i < 32; ++i) texels[3 * i] = static_cast<float>((i * 7) % 5) * 0.3f;
  texels[3 * 3] = 9;
  for (std::size_t x = 2; x < 7; ++x) texels[3 * (8 + x)] = x == 5 ? 20 : 0;
  return std::make_shared<TextureImage>(8, 4, std::move(texels));
}

// Irradiance of a surface that faces up, by the midpoint rule.
double irradiance_of(const Environment& environment) {
  constexpr int kRows = 500, kColumns = 1000;
  double sum = 0;
  for (int i = 0; i < kRows; ++i) {
    const double cosine = (i + 0.5) / kRows, sine = std::sqrt(1 - cosine * cosine);
    for (int j = 0; j < kColumns; ++j) {
      const double phi = 2 * std::numbers::pi * (j + 0.5) / kColumns;
      const Vec3 d{static_cast<float>(sine * std::cos(phi)), static_cast<float>(cosine),
                   static_cast<float>(sine * std::sin(phi))};
      sum += cosine * static_cast<double>(environment.radiance(d).r);
    }
  }
  return sum * 2 * std::numbers::pi / (kRows * kColumns);
}

TEST(EnvironmentImage, LightsAsItsIntegralSays) {
  for (const float rotation : {0.0f, 130.0f}) {
    test::SceneMaker maker = lit_square();
    maker.description().textures = {{.image = surroundings()}};
    maker.description().environment = {{Rgb::gray(2), 0}, rotation};
    const double irradiance = irradiance_of(Environment(Rgb::gray(2), surroundings(), rotation));
    expect_radiance(maker.build(), reflected(irradiance));
  }
}

TEST(EnvironmentImage, LightsAsItsIntegralSaysInEveryOrientation) {
  const Transform turned = compose(rotation({1, 2, -1}, 75), scaling({1, 1, -1}));
  test::SceneMaker maker = lit_square();
  maker.description().textures = {{.image = surroundings()}};
  maker.description().environment = {{Rgb::gray(2), 0}, 30, turned};
  const double irradiance = irradiance_of(Environment(Rgb::gray(2), surroundings(), 30, turned));
  expect_radiance(maker.build(), reflected(irradiance), 1000);
}

TEST(EnvironmentImage, IsTurnedByItsOrientation) {
  const auto image = surroundings();
  const Environment plain(Rgb::gray(1), image, 40), level(Rgb::gray(1), image, 0, rotation({0, 1, 0}, 40));
  const Transform turn = rotation({1, -2, 3}, 100);
  const Environment turned(Rgb::gray(1), image, 40, turn);
  for (const Vec3 d : {Vec3{1, 0.2f, 0.3f}, {-0.5f, 1, 0.1f}, {0.2f, -0.4f, -1}}) {
    EXPECT_NEAR(level.radiance(d).r, plain.radiance(d).r, 1e-3f);
    EXPECT_NEAR(turned.radiance(turn.direction(d)).r, plain.radiance(d).r, 1e-3f);
  }
}

// Seen by the camera itself, in a mirror, and as the light of a floor.
TEST(Environment, CanBeHiddenFromTheCamera) {
  for (const bool visible : {true, false})
    for (const Integrator integrator : {Integrator::kMis, Integrator::kWhitted}) {
      const auto seen = [&](std::optional<MaterialModel> model) {
        test::SceneMaker maker({.position = {0, 2, 0.1f}, .look_at = {}, .vertical_fov_degrees = 1});
        const auto material = maker.material(model.value_or(test::lambert(0)));
        maker.add(QuadDescription{{-1, model ? 0.0f : 9.0f, 1}, {2, 0, 0}, {0, 0, -2}, material});
        maker.description().environment = EnvironmentDescription{{Rgb::gray(1)}, 0, {}, visible};
        return test::mean_radiance(maker.build(), {.integrator = integrator}, 64).value;
      };
      EXPECT_NEAR(seen(std::nullopt), visible ? 1 : 0, 1e-5) << "the background";
      EXPECT_NEAR(seen(Mirror{}), 1, 0.01) << "in a mirror";
      EXPECT_NEAR(seen(test::lambert(0.5f)), 0.5, 0.05) << "as light";
    }
}

// An upright wall sees one side of the environment, and so the rotation.
TEST(EnvironmentImage, TurnsCounterClockwiseSeenFromAbove) {
  TextureImage image{4, 1,
                     std::vector<float>{1, 0, 0, 8, 0, 0, 1, 0, 0, 1, 0, 0}};  // bright between -x and -z
  const auto toward = [&](Vec3 d, float rotation) {
    return Environment(Rgb::gray(1), std::make_shared<TextureImage>(image), rotation).radiance(d).r;
  };
  const float s = std::sqrt(0.5f);
  EXPECT_NEAR(toward({-s, 0, -s}, 0), 8, 1e-4);
  EXPECT_NEAR(toward({s, 0, -s}, 0), 1, 1e-4);
  EXPECT_NEAR(toward({-s, 0, s}, 90), 8, 1e-4) << "from -z to -x is counter-clockwise, seen from +y";
  EXPECT_NEAR(toward({-s, 0, -s}, 90), 1, 1e-4);
  EXPECT_NEAR(toward({s, 0, -s}, -90), 8, 1e-4);
  EXPECT_NEAR(toward({-s, 0, -s}, 3600), 8, 1e-3);
}

}  // namespace
}  // namespace tessera::core
