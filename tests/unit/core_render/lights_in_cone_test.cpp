// SPDX-License-Identifier: Apache-2.0
#include "core/lights/lights_in_cone.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/scattered_lights.hpp"

namespace tessera::core::lights {
namespace {

// Balls strewn over a cube.
std::vector<LightTree::Item> strewn_balls(std::uint32_t count) {
  std::vector<LightTree::Item> items;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto u = test::numbers(static_cast<int>(i), 41);
    const SurfaceEmission emission{{Rgb::gray(1 + u[1])}, static_cast<double>(1 + u[1])};
    const AreaLight ball(SphereLight{test::point_in_cube(static_cast<int>(i), 40), 0.05f + 0.1f * u[0]}, {},
                         emission);
    items.push_back({ball.bounds(), i});
  }
  return items;
}

DoubleCone some_cone(int index, float degrees) {
  const float angle = degrees * (kPi / 180);
  return {test::point_in_cube(index, 42) * 0.5f, test::direction(index, 43), std::cos(angle),
          std::sin(angle)};
}

// The signed distance of a ball's centre from the cone, in radii: less than -1 within, more than 1 outside.
double radii_outside(const LightTree::Item& ball, const DoubleCone& cone) {
  const Aabb& box = ball.bounds.box();
  const Vec3 center = (box.lower + box.upper) * 0.5f - cone.apex;
  const double along = std::fabs(static_cast<double>(dot(center, cone.axis))),
               across = static_cast<double>(length(cross(center, cone.axis)));
  return (across * static_cast<double>(cone.cosine) - along * static_cast<double>(cone.sine)) /
         (box.extent(0) / 2);
}

TEST(LightsInCone, AreThoseThatMeetIt) {
  constexpr std::uint32_t kLamps = 300;  // so few that the tree is searched to its leaves
  const std::vector<LightTree::Item> balls = strewn_balls(kLamps);
  const LightTree tree = LightTree::build(balls, 1);
  int inside = 0;
  for (int i = 0; i < 50; ++i) {
    const DoubleCone narrow = some_cone(i, 12);
    const LightsInCone lights(tree, narrow);
    double sum = 0;
    for (std::uint32_t ball = 0; ball < kLamps; ++ball) {
      const double outside = radii_outside(balls[ball], narrow);
      const auto pmf = static_cast<double>(lights.pmf(ball));
      sum += pmf;
      if (outside < 0.99) {
        EXPECT_GT(pmf, 0) << i << ' ' << ball;
      }
      if (outside > 1.01) {
        EXPECT_EQ(pmf, 0) << i << ' ' << ball;
      }
      inside += outside < 0 ? 1 : 0;
    }
    EXPECT_EQ(lights.empty(), sum == 0);
    if (!lights.empty()) {
      EXPECT_NEAR(sum, 1, 1e-4);
    }
  }
  EXPECT_GT(inside, 50);
}

// All of what the apex sees within the cone is in proportion to emission and solid angle.
TEST(LightsInCone, CountByTheLightThatTheySend) {
  const LightTree tree =
      LightTree::build({{AreaLight(SphereLight{{0, 0, -4}, 0.1f}, {}, {{Rgb::gray(3)}, 3}).bounds(), 0},
                        {AreaLight(SphereLight{{0, 0, 2}, 0.1f}, {}, {{Rgb::gray(1)}, 1}).bounds(), 1},
                        {AreaLight(SphereLight{{4, 0, 0}, 0.1f}, {}, {{Rgb::gray(9)}, 9}).bounds(), 2}},
                       1);
  const LightsInCone lights(tree, {{0, 0, 0}, {0, 0, 1}, std::cos(0.2f), std::sin(0.2f)});
  const double first = 3.0 / 16, second = 1.0 / 4;
  EXPECT_NEAR(lights.pmf(0), first / (first + second), 1e-4);
  EXPECT_NEAR(lights.pmf(1), second / (first + second), 1e-4) << "on the other side of the apex";
  EXPECT_EQ(lights.pmf(2), 0);
  EXPECT_EQ(lights.pmf(3), 0) << "there is no such light";
  const double solid_angle = static_cast<double>(kPi) * 0.01 * (1.0 / 16 + 1.0 / 4);
  EXPECT_NEAR(lights.solid_angle(), solid_angle, 0.01 * solid_angle);
  EXPECT_TRUE(LightsInCone(tree, {{0, 0, 0}, {0, 1, 0}, std::cos(0.2f), std::sin(0.2f)}).empty());
}

// Also where so many meet the cone that the tree is not searched to its leaves.
TEST(LightsInCone, AreChosenWithTheirProbabilities) {
  constexpr std::uint32_t kLamps = 3000;
  const LightTree tree = LightTree::build(strewn_balls(kLamps), 1);
  for (const float degrees : {1.5f, 6.0f, 60.0f}) {
    constexpr int kChoices = 200'000;
    const LightsInCone lights(tree, some_cone(3, degrees));
    ASSERT_FALSE(lights.empty());
    std::vector<int> counts(kLamps);
    int lost = 0;
    for (int i = 0; i < kChoices; ++i) {
      const LightTree::Choice choice = lights.sample((i + 0.5) / kChoices);
      if (choice.light == kNoLight) {
        ++lost;
        continue;
      }
      ASSERT_NEAR(choice.pmf, lights.pmf(choice.light), 1e-5f * choice.pmf);
      ++counts[choice.light];
    }
    double sum = 0;
    for (std::uint32_t ball = 0; ball < kLamps; ++ball) {
      const auto pmf = static_cast<double>(lights.pmf(ball));
      EXPECT_NEAR(counts[ball], pmf * kChoices, 2 + 0.01 * pmf * kChoices) << degrees << ' ' << ball;
      sum += pmf;
    }
    EXPECT_NEAR(sum + static_cast<double>(lost) / kChoices, 1, 1e-3) << degrees;
    EXPECT_GT(sum, 0.1) << degrees;
  }
}

TEST(LightsInCone, AreTheSameAgain) {
  const LightTree one = LightTree::build(strewn_balls(3000), 1),
                  many = LightTree::build(strewn_balls(3000), 4);
  for (int i = 0; i < 200; ++i) {
    const LightsInCone a(one, some_cone(i, 8)), b(many, some_cone(i, 8));
    const double u = static_cast<double>(test::numbers(i, 44)[0]);
    EXPECT_EQ(a.sample(u).light, b.sample(u).light);
    EXPECT_EQ(a.sample(u).pmf, b.sample(u).pmf);
    EXPECT_EQ(a.solid_angle(), b.solid_angle());
  }
}

}  // namespace
}  // namespace tessera::core::lights
