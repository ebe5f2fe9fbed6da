// SPDX-License-Identifier: Apache-2.0
// What lamps of each shape do to a diffuse surface, against closed forms: every strategy finds it.
#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/mean_radiance.hpp"
#include "tests/unit/core_render/lit_square.hpp"

namespace tessera::core::integrators {
namespace {

using test::expect_radiance;
using test::lit_square;
using test::reflected;

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

}  // namespace
}  // namespace tessera::core::integrators
