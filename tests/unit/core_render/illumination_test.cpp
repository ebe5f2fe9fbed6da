// SPDX-License-Identifier: Apache-2.0
// What lights without a shape do to diffuse surfaces, against closed forms: every strategy finds it.
#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/mean_radiance.hpp"
#include "tests/unit/core_render/lit_square.hpp"

namespace tessera::core::integrators {
namespace {

using test::expect_radiance;
using test::lit_square;
using test::reflected;

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
double irradiance_of(const lights::Environment& environment) {
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
    const double irradiance = irradiance_of(lights::Environment(Rgb::gray(2), surroundings(), rotation));
    expect_radiance(maker.build(), reflected(irradiance));
  }
}

TEST(EnvironmentImage, LightsAsItsIntegralSaysInEveryOrientation) {
  const Transform turned = compose(rotation({1, 2, -1}, 75), scaling({1, 1, -1}));
  test::SceneMaker maker = lit_square();
  maker.description().textures = {{.image = surroundings()}};
  maker.description().environment = {{Rgb::gray(2), 0}, 30, turned};
  const double irradiance = irradiance_of(lights::Environment(Rgb::gray(2), surroundings(), 30, turned));
  expect_radiance(maker.build(), reflected(irradiance), 1000);
}

TEST(EnvironmentImage, IsTurnedByItsOrientation) {
  const auto image = surroundings();
  const lights::Environment plain(Rgb::gray(1), image, 40),
      level(Rgb::gray(1), image, 0, rotation({0, 1, 0}, 40));
  const Transform turn = rotation({1, -2, 3}, 100);
  const lights::Environment turned(Rgb::gray(1), image, 40, turn);
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
    return lights::Environment(Rgb::gray(1), std::make_shared<TextureImage>(image), rotation).radiance(d).r;
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
}  // namespace tessera::core::integrators
