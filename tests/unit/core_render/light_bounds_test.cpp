// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light_bounds.hpp"

#include <gtest/gtest.h>
#include <numbers>

#include <cmath>

#include "tests/support/scattered_lights.hpp"

namespace tessera::core::lights {
namespace {

LightBounds facing(const NormalCone& normals, bool two_sided = false) {
  return LightBounds({{{-1, -1, -1}, {1, 1, 1}}}, normals, Falloff::cosine(), 1, two_sided);
}

// A direction within the cone: at its edge, every other time.
Vec3 direction_in(const NormalCone& cone, int index) {
  const auto u = test::numbers(index, 20);
  const float cos_t = index % 2 == 0 ? cone.cos_o : 1 - u[0] * (1 - cone.cos_o), phi = 6.28f * u[1];
  const float sin_t = std::sqrt(std::max(0.0f, 1 - cos_t * cos_t));
  return Frame::around(cone.axis).to_world({sin_t * std::cos(phi), sin_t * std::sin(phi), cos_t});
}

TEST(LightBounds, HoldTheNormalsOfBoth) {
  int narrow = 0;
  for (int i = 0; i < 4000; ++i) {
    const bool two_sided = i % 3 == 0;
    const auto u = test::numbers(i, 21);
    const Vec3 axis = test::direction(i, 22), lean = test::direction(i, 23);
    const NormalCone a = NormalCone::around(axis, u[0] * u[0] * u[0]);
    const NormalCone b = NormalCone::around(normalize(axis + lean * (2 * u[2])), u[1] * u[1] * u[1]);
    LightBounds both = facing(a, two_sided);
    both.include(facing(b, false));
    EXPECT_EQ(both.two_sided(), two_sided);
    narrow += both.normals().is_all() ? 0 : 1;
    for (const auto& cone : {a, b}) {
      const float cosine = dot(direction_in(cone, i), both.normals().axis);
      EXPECT_GE(two_sided ? std::fabs(cosine) : cosine, both.normals().cos_o - 1e-5f) << i;
    }
  }
  EXPECT_GT(narrow, 1000) << "too few cases that say anything";
}

TEST(LightBounds, AreNoWiderThanTheyNeedBe) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, between = normalize(x + y);
  LightBounds both = facing(NormalCone::only(x));
  both.include(facing(NormalCone::only(y)));
  EXPECT_NEAR(both.normals().cos_o, std::cos(std::numbers::pi / 4), 1e-6);
  EXPECT_NEAR(dot(both.normals().axis, between), 1, 1e-6);
  both.include(facing(NormalCone::only(between)));
  EXPECT_NEAR(both.normals().cos_o, std::cos(std::numbers::pi / 4), 1e-6);
  both.include(facing(NormalCone::only(-x)));
  EXPECT_TRUE(both.normals().is_all());

  LightBounds sheet = facing(NormalCone::only(x), true);
  sheet.include(facing(NormalCone::only(-x), true));
  EXPECT_NEAR(sheet.normals().cos_o, 1, 1e-6) << "two-sided lights back to back face the same ways";
}

TEST(LightBounds, SumPowerAndBoundPlaces) {
  LightBounds bounds;
  bounds.include(PointLight({1, 2, 3}, {1, 2, 6}).bounds());
  bounds.include(PointLight({-1, 5, 0}, Rgb::gray(2)).bounds());
  EXPECT_NEAR(bounds.power(), 5 * 4 * std::numbers::pi, 1e-5);
  EXPECT_NEAR(bounds.intensity(), 5, 1e-6);
  EXPECT_EQ(bounds.box(), (Aabb{{-1, 2, 0}, {1, 5, 3}}));
}

// The power of bounds is that of the light; of spots, which fall off at the edge, a little more.
TEST(LightBounds, HaveThePowerOfTheLight) {
  for (const Light& light : test::scattered_lights(200)) {
    const double of_bounds = bounds(light)->power(), of_light = power(light, 1);
    if (!std::holds_alternative<SpotLight>(light)) {
      EXPECT_NEAR(of_bounds, of_light, 1e-5 * of_light);
    } else {
      EXPECT_GE(of_bounds, 0.999 * of_light);
      EXPECT_LE(of_bounds, 2 * of_light);
    }
  }
}

TEST(LightBounds, MeasureTheFalloffOverAllDirections) {
  for (const float theta_o : {0.0f, 0.4f, 1.5f})
    for (const float theta_e : {0.2f, 1.0f, 1.5707963f}) {
      const NormalCone cone = NormalCone::around({0, 0, 1}, 1 - std::cos(theta_o));
      const Falloff falloff{std::cos(theta_e), theta_e + std::sin(theta_e) * std::cos(theta_e)};
      constexpr int kSteps = 10000;
      double integral = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double theta = std::numbers::pi * (i + 0.5) / kSteps;
        const double beyond = std::max(0.0, theta - static_cast<double>(theta_o));
        if (beyond < static_cast<double>(theta_e))
          integral += 2 * std::numbers::pi * std::sin(theta) * std::cos(beyond) * std::numbers::pi / kSteps;
      }
      const LightBounds bounds({{Vec3{}, Vec3{}}}, cone, falloff, 1, false);
      EXPECT_NEAR(bounds.orientation_measure(), integral, 2e-3) << theta_o << ' ' << theta_e;
    }
}

}  // namespace
}  // namespace tessera::core::lights
