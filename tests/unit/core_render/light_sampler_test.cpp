// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light_sampler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/lights/normal_bins.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/scattered_lights.hpp"

namespace tessera::core::lights {
namespace {

using Among = LightSampler::Among;

// Its upper half is far brighter than the lower one.
Environment uneven_sky(float radiance) {
  constexpr int kWidth = 16, kHeight = 8, kHalf = 3 * kWidth * kHeight / 2;
  std::vector<float> texels(kHalf, 8.0f);
  texels.resize(2 * kHalf, 0.1f);
  return {Rgb::gray(radiance),
          std::make_shared<TextureImage>(TextureImage{kWidth, kHeight, std::move(texels)}), 0};
}

std::vector<Light> with_sun_and_sky(std::vector<Light> lights) {
  lights.emplace_back(DirectionalLight(normalize({1, -2, 0.5f}), Rgb::gray(0.2f)));
  lights.emplace_back(uneven_sky(0.05f));
  return lights;
}

constexpr MisCompensation kOff = MisCompensation::kOff, kOn = MisCompensation::kOn;

// Whether there are a sun and a sky; and the compensation.
class Frequencies : public testing::TestWithParam<std::tuple<bool, MisCompensation>> {
 protected:
  std::vector<Light> with_lamps(int lamps) const {
    auto scattered = test::scattered_lights(lamps);
    return std::get<0>(GetParam()) ? with_sun_and_sky(std::move(scattered)) : scattered;
  }
  const MisCompensation compensation_ = std::get<1>(GetParam());
};

// Pearson's test, with one more cell for choosing none. Each choice also carries its light's pmf.
TEST_P(Frequencies, AreThePmf) {
  constexpr int kSamples = 20000;
  const auto lights = with_lamps(120);
  const LightSampler sampler(lights, Among::kAll, 1);
  for (int p = 0; p < 12; ++p) {
    const LightSampleContext point = test::light_context(p);
    std::vector<double> expected(lights.size() + 1), observed(lights.size() + 1);
    double sum = 0;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
      const auto pmf = static_cast<double>(sampler.pmf(point, i, compensation_));
      const bool spared = compensation_ == kOn && std::holds_alternative<Environment>(lights[i]);
      EXPECT_GE(pmf, spared ? 0 : 0.0999 / static_cast<double>(lights.size()));
      expected[i] = pmf * kSamples;
      sum += pmf;
    }
    ASSERT_LE(sum, 1 + 1e-5);
    expected.back() = (1 - sum) * kSamples;
    for (int s = 0; s < kSamples; ++s) {
      const auto u = test::numbers(s, static_cast<std::uint32_t>(40 + p));
      const auto choice = sampler.sample(
          point, static_cast<double>(u[0]) + static_cast<double>(u[1]) * 0x1p-24, compensation_);
      observed[choice.light == kNoLight ? lights.size() : choice.light] += 1;
      if (choice.light == kNoLight) continue;
      ASSERT_NEAR(choice.pmf, sampler.pmf(point, choice.light, compensation_), 1e-5f * choice.pmf);
    }
    test::expect_chi_square(observed, expected, 20);
  }
}

INSTANTIATE_TEST_SUITE_P(LightSampler, Frequencies,
                         testing::Combine(testing::Values(false, true), testing::Values(kOff, kOn)),
                         [](const auto& test_case) {
                           return std::string(std::get<0>(test_case.param) ? "WithSunAndSky" : "OfLamps") +
                                  (std::get<1>(test_case.param) == kOn ? "BesideBsdfSamples" : "Alone");
                         });

// With a tree of many nodes, of one node, and of one lamp; and for a single light.
TEST_P(Frequencies, OfEightPointsAreThoseOfEach) {
  for (const int count : {120, 5, 1}) {
    const LightSampler sampler(with_lamps(count), Among::kAll, 1);
    for (int i = 0; i < 500; ++i) {
      Vec3Lanes position, normal;
      DoubleLanes u;
      for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
        const int n = 8 * i + static_cast<int>(lane);
        const LightSampleContext point = test::light_context(n);
        position.set(lane, point.position);
        normal.set(lane, n % 5 == 0 ? Vec3{} : point.normal);
        u.set(lane, static_cast<double>(test::numbers(n, 42)[0]));
      }
      const unsigned asked = 0xb7;
      const LightSampleContexts points{position.all(), normal.all()};
      const auto [chosen, pmf] = sampler.sample(points, u, asked, compensation_);
      const WordLanes light(chosen);
      const FloatLanes probability(pmf);
      for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
        if ((asked >> lane & 1) == 0) continue;
        const auto alone = sampler.sample({position[lane], normal[lane]}, u[lane], compensation_);
        ASSERT_EQ(light[lane], alone.light);
        ASSERT_EQ(probability[lane], alone.pmf);
      }
      if (!std::get<0>(GetParam())) continue;
      const FloatLanes of_sky(sampler.environment_pmf(points, compensation_));
      const auto sky = static_cast<std::uint32_t>(sampler.size() - 1);
      for (std::size_t lane = 0; lane < kLaneCount; ++lane)
        ASSERT_EQ(of_sky[lane], sampler.pmf({position[lane], normal[lane]}, sky, compensation_));
    }
  }
}

TEST(LightSampler, FindsAFaintLightBesideOneBrighterByAnyFactor) {
  const LightSampler lamps({PointLight({1, 0, 0}, Rgb::gray(1e-6f)), PointLight({2, 0, 0}, Rgb::gray(1e12f))},
                           Among::kAll, 1);
  EXPECT_GE(lamps.pmf({}, 0), 0.0499f);
  const LightSampler sunlit(
      {PointLight({1, 0, 0}, Rgb::gray(1e-6f)), DirectionalLight({0, -1, 0}, Rgb::gray(1e12f)),
       Environment(Rgb::gray(1e-3f), nullptr, 0)},
      Among::kAll, 1);
  for (std::uint32_t light = 0; light < 3; ++light) EXPECT_GE(sunlit.pmf({}, light), 0.1f) << light;
}

// By irradiance, of even environment by a quarter of it, three times in four but for those alike.
TEST(LightSampler, WeighsLightsAtInfinityByWhatTheySendToTheSurface) {
  const LightSampler sampler({PointLight({0, 2, 0}, Rgb::gray(4)), DirectionalLight({0, -1, 0}, Rgb::gray(6)),
                              Environment(Rgb::gray(4 / kPi), nullptr, 0)},
                             Among::kAll, 1);
  const auto expected = [](double part) { return 0.1 / 3 + 0.9 * (0.75 * part + 0.25 / 3); };
  const LightSampleContext below{{0, 0, 0}, {0, 1, 0}};
  EXPECT_NEAR(sampler.pmf(below, 0), expected(1.0 / 8), 3e-3);
  EXPECT_NEAR(sampler.pmf(below, 1), expected(6.0 / 8), 3e-3);
  EXPECT_NEAR(sampler.pmf(below, 2), expected(1.0 / 8), 3e-3);
  for (std::uint32_t light = 0; light < 3; ++light)
    EXPECT_NEAR(sampler.pmf({{0, 0, 0}, {}}, light), expected(light == 1 ? 6.0 / 8 : 1.0 / 8), 1e-4);
  const LightSampleContext turned_away{{0, 0, 0}, {0, -1, 0}};
  EXPECT_NEAR(sampler.pmf(turned_away, 0), 0.1 / 3, 1e-6);
  EXPECT_NEAR(sampler.pmf(turned_away, 1), 0.1 / 3, 1e-6);
  EXPECT_NEAR(sampler.pmf(turned_away, 2), 0.1 / 3 + 0.9, 1e-6);
}

TEST(LightSampler, WeighsAnUnevenSkyByWhichWayTheSurfaceFaces) {
  const Environment sky = uneven_sky(1);
  const DirectionalLight sun({0, -1, 0}, Rgb::gray(3));
  const LightSampler sampler({sun, sky}, Among::kAll, 1);
  const auto importance = [&](Vec3 normal) {
    return sky.importance_by_normal()[normal_bin(normal)].uncompensated;
  };
  ASSERT_GT(importance({0, 1, 0}), 3 * importance({0, -1, 0}));
  for (const Vec3 normal : {Vec3{0, 1, 0}, normalize({1, 1, 0}), normalize({-2, 1, 3}), Vec3{}}) {
    const double of_sun = normal == Vec3{} ? 3 : 3 * static_cast<double>(normal.y);
    const double part = importance(normal) / (importance(normal) + of_sun);
    EXPECT_NEAR(sampler.pmf({{}, normal}, 1), 0.1 / 2 + 0.9 * (0.75 * part + 0.25 / 2), 1e-6);
  }
}

// A lamp of irradiance E beside an even sky of Y: beside BSDF samples, the sky counts max(0, Y / 4 - E) / 2.
TEST(LightSampler, LeavesAnEvenSkyToBsdfSamples) {
  for (const double lamp : {0.1, 0.5, 0.9, 1.1, 100.0}) {
    constexpr double kSky = 4;
    const LightSampler sampler({DirectionalLight({0, -1, 0}, Rgb::gray(static_cast<float>(lamp))),
                                Environment(Rgb::gray(4 / kPi), nullptr, 0)},
                               Among::kAll, 1);
    const double weight = std::max(0.0, kSky / 4 - lamp) / 2, even = std::min(1.0, weight / kSky);
    const double share = 0.75 * weight / (weight + lamp) + 0.25 * even / (even + 1);
    for (const Vec3 normal : {Vec3{0, 1, 0}, Vec3{}}) {
      EXPECT_NEAR(sampler.pmf({{}, normal}, 1, kOn), 0.9 * share, 1e-2);
      EXPECT_NEAR(sampler.pmf({{}, normal}, 0, kOn), 1 - 0.9 * share, 1e-2);
    }
    EXPECT_NEAR(sampler.pmf({{}, {0, -1, 0}}, 1, kOn), 0.9, 1e-6) << "no other light reaches the surface";
  }
}

// A sun in the environment competes with a lamp by its irradiance.
TEST(LightSampler, WeighsASunOfTheEnvironmentBesideALamp) {
  std::vector<float> texels(std::size_t{3} * 64 * 32, 1e-3f);
  std::fill_n(texels.begin() + 3 * (64 * 9 + 20), 3, 1000.0f);
  const Environment sky(Rgb::gray(1), std::make_shared<TextureImage>(TextureImage{64, 32, texels}), 0);
  const LightSampler sampler({DirectionalLight({0, -1, 0}, Rgb::gray(1)), sky}, Among::kAll, 1);
  const auto [uncompensated, total, excess] = sky.importance_by_normal()[normal_bin(Vec3{0, 1, 0})];
  ASSERT_GT(excess, 0.9 * total);
  const double even = excess / total, share = 0.75 * excess / (excess + 1) + 0.25 * even / (even + 1);
  EXPECT_NEAR(sampler.pmf({{}, {0, 1, 0}}, 1, kOn), 0.9 * share, 1e-6);
}

TEST(LightSampler, WeighsEachColorAlike) {
  const LightSampler sampler({PointLight({0, 1, 0}, {0, 0, 1}), PointLight({0, -1, 0}, {0, 1, 0})},
                             Among::kAll, 1);
  EXPECT_NEAR(sampler.pmf({}, 0), 0.5, 1e-6);
}

TEST(LightSampler, ChoosesAmongLightsThatNoRayMeets) {
  const auto lights = with_sun_and_sky(test::scattered_lights(50));
  const LightSampler sampler(lights, Among::kDelta, 1);
  for (int i = 0; i < 1000; ++i) {
    const auto choice = sampler.sample(test::light_context(i), static_cast<double>(test::numbers(i, 41)[0]));
    EXPECT_TRUE(choice.light == kNoLight || is_delta(lights[choice.light]));
  }
  for (std::uint32_t i = 0; i < lights.size(); ++i)
    EXPECT_EQ(sampler.pmf(test::light_context(1), i) > 0, is_delta(lights[i])) << i;
}

TEST(LightSampler, AlwaysChoosesTheOnlyLight) {
  const LightSampler sampler({PointLight({0, 1, 0}, Rgb::gray(1))}, Among::kAll, 1);
  EXPECT_EQ(sampler.sample({{0, 0, 0}, {0, -1, 0}}, 0.7).pmf, 1);
  EXPECT_EQ(sampler.pmf({}, 0), 1);
  EXPECT_TRUE(LightSampler({}, Among::kAll, 1).empty());
  EXPECT_TRUE(LightSampler({Environment(Rgb::gray(1), nullptr, 0)}, Among::kDelta, 1).empty());
}

}  // namespace
}  // namespace tessera::core::lights
