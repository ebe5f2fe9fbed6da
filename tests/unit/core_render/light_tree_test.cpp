// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/scattered_lights.hpp"

namespace tessera::core::lights {
namespace {

// Whether anything at all arrives at the point, by more than rounding.
bool shines_on(const Light& light, const LightSampleContext& point, int index) {
  const auto u = test::numbers(index, 30);
  const auto sample = sample_light(light, {}, point, {u[0], u[1]});
  constexpr float kClearly = 1e-4f;
  if (!sample) return false;
  if (std::holds_alternative<AreaLight>(light) &&
      std::fabs(dot(sample->wi, sample->point->geometric_normal)) < kClearly)
    return false;
  return point.normal == Vec3{} || dot(sample->wi, point.normal) > kClearly;
}

TEST(LightTree, FindsEveryLightThatShinesOnThePoint) {
  const auto lights = test::scattered_lights(300);
  const LightTree tree = LightTree::build(test::tree_items(lights), 1);
  int emitting = 0;
  for (int i = 0; i < 100; ++i) {
    const LightSampleContext point = test::light_context(i);
    EXPECT_GT(tree.irradiance(point), 0);
    for (std::uint32_t light = 0; light < lights.size(); ++light) {
      if (!shines_on(lights[light], point, i)) continue;
      ++emitting;
      EXPECT_GT(tree.pmf(point, light), 0) << "point " << i << ", light " << light;
    }
  }
  EXPECT_GT(emitting, 5000);
}

// Of one light alone, the tree's estimate is close to what arrives.
TEST(LightTree, KnowsWhatALampSends) {
  const auto irradiance = [](const LightBounds& bounds, const LightSampleContext& point) {
    return LightTree::build({{bounds, 0}}, 1).irradiance(point);
  };
  const LightBounds point = PointLight({0, 3, 0}, Rgb::gray(18)).bounds();
  EXPECT_NEAR(irradiance(point, {{0, 0, 0}, {0, 1, 0}}), 2, 1e-3);
  EXPECT_NEAR(irradiance(point, {{0, 0, 0}, normalize({1, 1, 0})}), 2 * std::sqrt(0.5), 1e-3);
  EXPECT_EQ(irradiance(point, {{0, 0, 0}, {0, -1, 0}}), 0);
  EXPECT_NEAR(irradiance(point, {{0, 0, 0}, {}}), 2, 1e-3);
  const SurfaceEmission emission{{Rgb::gray(50)}, 50, false};
  const LightBounds panel =
      AreaLight(QuadLight{{0, 5, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}}, {0, -1, 0}, emission).bounds();
  EXPECT_NEAR(irradiance(panel, {{0, 0, 0}, {0, 1, 0}}), 50 * 0.01 / 25, 5e-4);
  EXPECT_EQ(irradiance(panel, {{0, 6, 0}, {0, -1, 0}}), 0) << "it emits to its front only";
  EXPECT_EQ(irradiance(panel, {{9, 6, 0}, {}}), 0);
}

TEST(LightTree, PrefersWhatIsNear) {
  const LightTree tree = LightTree::build(
      {{PointLight({0, 1, 0}, Rgb::gray(1)).bounds(), 4}, {PointLight({0, 10, 0}, Rgb::gray(1)).bounds(), 7}},
      1);
  EXPECT_NEAR(tree.pmf({{0, 0, 0}, {}}, 4), 100.0 / 101, 1e-3);
  EXPECT_NEAR(tree.pmf({{0, 0, 0}, {}}, 7), 1.0 / 101, 1e-3);
  EXPECT_EQ(tree.pmf({{0, 0, 0}, {}}, 5), 0) << "there is no such light";
  EXPECT_NEAR(tree.pmf({{0, 2, 0}, {0, 1, 0}}, 7), 1, 1e-6) << "the other is behind";
}

TEST(LightTree, IsTheSameForAnyNumberOfThreads) {
  const auto lights = test::scattered_lights(30000);
  const LightTree one = LightTree::build(test::tree_items(lights), 1),
                  many = LightTree::build(test::tree_items(lights), 4);
  for (int i = 0; i < 2000; ++i) {
    const LightSampleContext point = test::light_context(i);
    const double u = static_cast<double>(test::numbers(i, 31)[0]);
    const LightTree::Choice a = one.sample(point, u), b = many.sample(point, u);
    EXPECT_EQ(a.light, b.light);
    EXPECT_EQ(a.pmf, b.pmf);
  }
}

// A single number has digits enough to tell a hundred thousand lights apart.
TEST(LightTree, ReachesEachOfManyAlike) {
  constexpr int kSide = 46, kLights = kSide * kSide * kSide, kPerLight = 8;
  std::vector<LightTree::Item> items;
  for (int i = 0; i < kLights; ++i) {
    const Vec3 place{static_cast<float>(i % kSide), static_cast<float>(i / kSide % kSide),
                     static_cast<float>(i / (kSide * kSide))};
    items.push_back({PointLight(place, Rgb::gray(1)).bounds(), static_cast<std::uint32_t>(i)});
  }
  const LightTree tree = LightTree::build(std::move(items), 2);
  const LightSampleContext far_away{{1e5f, 2e5f, 3e5f}, {}};
  std::vector<int> chosen(kLights);
  for (int i = 0; i < kLights * kPerLight; ++i)
    ++chosen[tree.sample(far_away, (i + 0.5) / (kLights * kPerLight)).light];
  for (int i = 0; i < kLights; ++i) {
    EXPECT_NEAR(chosen[static_cast<std::size_t>(i)], kPerLight, 2) << i;
    if (i % 1000 == 0) {
      EXPECT_NEAR(tree.pmf(far_away, static_cast<std::uint32_t>(i)) * kLights, 1, 2e-3);
    }
  }
}

// Lights in one place, and at places so far apart that squares hardly fit a float.
TEST(LightTree, IsBuiltOverLightsAnywhere) {
  std::vector<LightTree::Item> items;
  for (std::uint32_t i = 0; i < 100; ++i)
    items.push_back({PointLight(i < 50 ? Vec3{1, 1, 1} : test::point_in_cube(static_cast<int>(i), 32) * 1e14f,
                                Rgb::gray(i % 7 == 0 ? 1e20f : 1e-20f))
                         .bounds(),
                     i});
  const LightTree tree = LightTree::build(std::move(items), 1);
  for (const LightSampleContext& point :
       {LightSampleContext{{1, 1, 1}, {}}, LightSampleContext{{0, 0, 0}, {0, 1, 0}},
        LightSampleContext{{1e15f, 1e15f, 1e15f}, {}}}) {
    double sum = 0;
    for (std::uint32_t i = 0; i < 100; ++i) {
      ASSERT_TRUE(std::isfinite(tree.pmf(point, i)));
      sum += static_cast<double>(tree.pmf(point, i));
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_NE(tree.sample(point, 0.5).light, kNoLight);
  }
}

}  // namespace
}  // namespace tessera::core::lights
