// SPDX-License-Identifier: Apache-2.0
#include "core/lights/environment.hpp"

#include <gtest/gtest.h>
#include <numbers>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/lights/normal_bins.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"
#include "tests/unit/core_render/sky_image.hpp"

namespace tessera::core::lights {
namespace {

using test::sky_image;
using test::SkyImage;

// Only the texel and those beside it, between which it is interpolated.
TEST(EnvironmentSampling, OneBrightTexelGetsAllSamples) {
  const Environment environment(
      Rgb::gray(1), sky_image(64, 32, [](int x, int y) { return x == 20 && y == 9 ? 1000.0f : 0.0f; }), 0);
  for (int i = 0; i < 1000; ++i) {
    const auto u = sampling::Sampler(8, i, 0, 0).pad(0);
    const auto s = environment.sample(Vec3{}, Vec2{u[0], u[1]});
    if (!s) continue;
    const double theta = std::acos(static_cast<double>(s->wi.y));
    const double phi = std::atan2(static_cast<double>(s->wi.x), static_cast<double>(-s->wi.z));
    EXPECT_NEAR(theta, std::numbers::pi * 9.5 / 32, 1.5 * std::numbers::pi / 32);
    EXPECT_NEAR(phi, 2 * std::numbers::pi * (20.5 / 64 - 0.5), 1.5 * 2 * std::numbers::pi / 64);
  }
}

// Where one texel outshines the rest by any factor, the rest is still sampled.
TEST(EnvironmentSampling, FindsAFaintSkyBesideASun) {
  const Environment environment(
      Rgb::gray(1), sky_image(64, 32, [](int x, int y) { return x == 20 && y == 29 ? 1e9f : 1.0f; }), 0);
  constexpr int kSamples = 100000;
  double from_above = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto u = sampling::Sampler(9, i % 1000, i / 1000, 0).pad(0);
    const auto s = environment.sample(Vec3{}, Vec2{u[0], u[1]});
    if (s && s->wi.y > 0) from_above += static_cast<double>(s->radiance.g / s->pdf) / kSamples;
  }
  EXPECT_NEAR(from_above, 2 * std::numbers::pi, 0.05 * 2 * std::numbers::pi);
}

// What little falls on a cell that is seldom chosen falls on all of its texels: here the rows next to the
// poles, of which the first gets a 65,000th of the cell.
TEST(EnvironmentSampling, FindsEveryTexelOfARareCell) {
  constexpr int kRows = 4096;
  for (const bool upper : {true, false}) {
    const auto striped = sky_image(128, kRows, [&](int x, int y) {
      return (y > kRows / 2) == upper ? 1 : x % 4 == 0 ? 0.2f : 0.02f;
    });
    const Environment environment(Rgb::gray(1), striped, 0);
    const Vec3 away{0, upper ? -1.0f : 1.0f, 0};
    constexpr float kOfThePole = 1.0f / (1 << 12);  // more than its cells get of all samples
    std::array<int, 20> found{};
    constexpr int kSamples = 1 << 19;
    for (int i = 0; i < kSamples; ++i) {
      const auto u = sampling::Sampler(13, i % 1000, i / 1000, 0).pad(0);
      const float y = std::floor(u[1] * kOfThePole * 0x1p24f) * 0x1p-24f;
      const auto s = environment.sample(away, Vec2{u[0], upper ? y : 1 - 0x1p-24f - y});
      ASSERT_TRUE(s);
      const double from_pole =
          std::asin(std::hypot(static_cast<double>(s->wi.x), static_cast<double>(s->wi.z)));
      const auto row = static_cast<std::size_t>(from_pole / std::numbers::pi * kRows);
      if (row < found.size()) ++found[row];
    }
    for (std::size_t row = 0; row < found.size(); ++row)
      EXPECT_GT(found[row], 0) << row << (upper ? " from above" : " from below");
  }
}

// Where a sun fades, samples count as much as where it is brightest: it is sampled as it is interpolated.
TEST(EnvironmentSampling, SamplesOfASunCountAlike) {
  const auto sun = [](int x, int y) { return std::abs(x - 136) <= 2 && std::abs(y - 40) <= 2 ? 1e6f : 1.0f; };
  const Environment environment(Rgb::gray(1), sky_image(512, 256, sun), 0);
  int fading = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto u = sampling::Sampler(14, i, 0, 0).pad(0);
    const auto s = environment.sample(Vec3{}, Vec2{u[0], u[1]});
    ASSERT_TRUE(s);
    if (s->radiance.g < 1e3f) continue;
    fading += s->radiance.g < 0.9e6f ? 1 : 0;
    const double counts = static_cast<double>(s->radiance.g / s->pdf);
    EXPECT_NEAR(counts / (environment.power(1) / std::numbers::pi / 0.9), 1, 0.03) << i;
  }
  EXPECT_GT(fading, 300);
}

// Of a sky that is the same all over, 19 samples in 20 are in proportion to the cosine, whichever way the
// surface faces and the image is turned; those that go by a surface's edge are few.
TEST(EnvironmentSampling, LooksWhereTheSurfaceFaces) {
  constexpr int kSamples = 4000;
  for (const float rotation : {0.0f, 77.0f, -200.0f}) {
    const Environment environment(Rgb::gray(1), sky_image(64, 32, [](int, int) { return 1.0f; }), rotation);
    for (int n = 0; n < 26; ++n) {
      const Vec3 normal = n < 6 ? Vec3{static_cast<float>(n == 0) - static_cast<float>(n == 1),
                                       static_cast<float>(n == 2) - static_cast<float>(n == 3),
                                       static_cast<float>(n == 4) - static_cast<float>(n == 5)}
                                : sampling::sample_sphere({sampling::Sampler(11, n, 0, 0).pad(0)[0],
                                                           sampling::Sampler(11, n, 0, 0).pad(0)[1]});
      int in_front = 0, high = 0;
      for (int i = 0; i < kSamples; ++i) {
        const auto u = sampling::Sampler(10, i % 100, i / 100, 0).pad(0);
        const auto s = environment.sample(normal, Vec2{u[0], u[1]});
        ASSERT_TRUE(s);
        in_front += dot(s->wi, normal) > 0 ? 1 : 0;
        high += dot(s->wi, normal) > 0.5f ? 1 : 0;
      }
      EXPECT_GT(in_front, 0.93 * kSamples) << n;
      EXPECT_NEAR(high, (0.95 * 0.75 + 0.05 * 0.25) * kSamples, 0.05 * kSamples) << n;
    }
  }
}

// However low a sun stands, no sample of it counts for much more than all of its light, which is less even in
// its one texel, being interpolated. Beyond the edge of a cell half of it is seen, for an eighth of the mean:
// there samples count for four times as much.
TEST(EnvironmentSampling, FindsASunJustOverTheHorizon) {
  for (const int column : {0, 19, 47, 100}) {
    const Environment environment(
        Rgb::gray(1), sky_image(128, 64, [&](int x, int y) { return x == column && y == 30 ? 1e4f : 1e-3f; }),
        0);
    for (int i = 0; i < 900; ++i) {
      const auto u = sampling::Sampler(12, i, column, 0).pad(0);
      const double aside = i % 3 == 0 ? 0 : static_cast<double>(u[2]) * 1.9 - 0.95;
      const double longitude = 2 * std::numbers::pi * ((column + 0.5 + aside) / 128 - 0.5);
      const Vec3 sun{static_cast<float>(std::sin(longitude)), 0.07f,
                     static_cast<float>(-std::cos(longitude))};
      const Vec3 normal = sampling::sample_sphere({u[0], u[1]});
      const double cosine = static_cast<double>(dot(normalize(sun), normal));
      if (cosine < 0.02) continue;
      const double counts =
          cosine * static_cast<double>(environment.radiance(sun).g / environment.pdf(normal, sun));
      const double all = environment.power(1) / std::numbers::pi;
      EXPECT_LT(counts, (aside == 0 ? 1 : 4) * std::max(2.5 * cosine, 0.75) * all) << i;
      const auto [uncompensated, total, excess] = environment.importance_by_normal()[normal_bin(normal)];
      EXPECT_GT(uncompensated, 0) << i;
      EXPECT_GT(excess, 0.9 * total) << i;
    }
  }
}

TEST(EnvironmentSampling, ReachesBothEndsOfItsRange) {
  const Environment environment(Rgb::gray(1), sky_image(64, 32, [](int, int) { return 1.0f; }), 0);
  constexpr float kJustBelowOne = 1 - 0x1p-24f;
  const auto top = environment.sample(Vec3{}, Vec2{0, 0});
  const auto bottom = environment.sample(Vec3{}, Vec2{kJustBelowOne, kJustBelowOne});
  ASSERT_TRUE(top && bottom);
  EXPECT_NEAR(top->wi.y, 1, 1e-6);
  EXPECT_NEAR(bottom->wi.y, -1, 1e-6);
}

TEST(EnvironmentSampling, HasADensityForWhatIsNoDirection) {
  const Environment environment(
      Rgb::gray(1), sky_image(128, 64, [](int x, int y) { return x == 1 && y == 1 ? 1e4f : 1.0f; }), 0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isfinite(environment.pdf({0, 1, 0}, {nan, nan, nan})));
}

TEST(EnvironmentSampling, BlackSurroundingsHaveNoPower) {
  EXPECT_EQ(Environment(Rgb::gray(0), nullptr, 0).power(1), 0);
  EXPECT_EQ(Environment(Rgb::gray(1), sky_image(7, 3, [](int, int) { return 0.0f; }), 0).power(1), 0);
}

// A sun counts in full where it is seen, the sky a quarter.
TEST(EnvironmentSampling, SeeksTheSunMoreThanTheSky) {
  const auto importance = [](const SkyImage& sky, Vec3 normal) {
    return Environment(Rgb::gray(1), sky, 0).importance_by_normal()[normal_bin(normal)].uncompensated;
  };
  const auto even = sky_image(64, 32, [](int, int) { return 1.0f; });
  const auto sun = sky_image(64, 32, [](int x, int y) { return x == 20 && y == 9 ? 1e5f : 0.0f; });
  EXPECT_NEAR(importance(even, {0, 1, 0}), std::numbers::pi / 4, 0.02);
  EXPECT_NEAR(importance(even, {0, 0, 0}), std::numbers::pi / 4, 1e-3);
  const double theta = std::numbers::pi * 9.5 / 32,
               solid_angle = std::sin(theta) * std::pow(std::numbers::pi / 32, 2);
  EXPECT_NEAR(importance(sun, {0, 1, 0}), 1e5 * solid_angle * std::cos(theta), 0.1 * 1e5 * solid_angle);
  EXPECT_LT(importance(sun, {0, -1, 0}), 0.03 * importance(sun, {0, 1, 0}));
  EXPECT_GT(importance(sun, {0, -1, 0}), 0);
}

// Of an even sky nothing exceeds the mean, of a sun all. A gradient from 1 to 3 exceeds its mean, as a
// surface that faces all sides receives it, by half a unit on one half of the sphere.
TEST(EnvironmentSampling, KnowsWhatExceedsTheMean) {
  const auto importance = [](const SkyImage& sky, Vec3 normal) {
    return Environment(Rgb::gray(1), sky, 0).importance_by_normal()[normal_bin(normal)];
  };
  const auto even = sky_image(64, 32, [](int, int) { return 1.0f; });
  const auto sun = sky_image(64, 32, [](int x, int y) { return x == 20 && y == 9 ? 1e6f : 1.0f; });
  const auto halves = sky_image(64, 32, [](int x, int) { return x < 32 ? 1.0f : 3.0f; });
  for (const Vec3 normal : {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{}}) {
    EXPECT_NEAR(importance(even, normal).total, std::numbers::pi, 0.02);
    EXPECT_NEAR(importance(even, normal).excess, 0, 1e-9);
  }
  EXPECT_GT(importance(sun, {0, 1, 0}).excess, 0.97 * importance(sun, {0, 1, 0}).total);
  EXPECT_NEAR(importance(halves, {}).total, 2 * std::numbers::pi, 0.02);
  EXPECT_NEAR(importance(halves, {}).excess, std::numbers::pi / 2, 0.05);
}

// Beside the samples of a diffuse surface, of a sky with a bright sun only the sun is sampled, and an even
// sky as without them.
TEST(EnvironmentSampling, LeavesToBsdfSamplesWhatTheyFind) {
  const auto even = sky_image(64, 32, [](int, int) { return 1.0f; });
  const auto sun = sky_image(64, 32, [](int x, int y) { return x == 20 && y == 9 ? 1e5f : 1.0f; });
  const Environment even_sky(Rgb::gray(1), even, 0), sunny(Rgb::gray(1), sun, 0);
  const Vec3 up{0, 1, 0};
  for (int i = 0; i < 1000; ++i) {
    const auto u = sampling::Sampler(15, i, 0, 0).pad(0);
    const Vec3 wi = sampling::sample_sphere({u[0], u[1]});
    EXPECT_NEAR(even_sky.pdf(up, wi, MisCompensation::kOn), even_sky.pdf(up, wi, MisCompensation::kOff),
                1e-3f);
    if (wi.y < 0.35f) {
      EXPECT_EQ(sunny.pdf(up, wi, MisCompensation::kOn), 0);
      EXPECT_GT(sunny.pdf(up, wi, MisCompensation::kOff), 0);
    }
    const auto s = sunny.sample(up, Vec2{u[2], u[3]}, MisCompensation::kOn);
    ASSERT_TRUE(s);
    EXPECT_GT(s->wi.y, 0.35f);
  }
}

TEST(EnvironmentImage, LiesAsItIsSeenFromInside) {
  // From left to right: 1 to 8; the rows times 1 and 10.
  const Environment environment(
      Rgb::gray(1),
      sky_image(8, 2, [](int x, int y) { return static_cast<float>((x + 1) * (y == 0 ? 1 : 10)); }), 0);
  const auto seen = [&](double u, double v) {
    const double longitude = 2 * std::numbers::pi * (u - 0.5), latitude = std::numbers::pi * (v - 0.5);
    return environment
        .radiance({static_cast<float>(std::cos(latitude) * std::sin(longitude)),
                   static_cast<float>(std::sin(latitude)),
                   static_cast<float>(-std::cos(latitude) * std::cos(longitude))})
        .r;
  };
  for (int x = 0; x < 8; ++x) {
    EXPECT_NEAR(seen((x + 0.5) / 8, 0.75), x + 1, 1e-4);
    EXPECT_NEAR(seen((x + 0.5) / 8, 0.25), 10 * (x + 1), 1e-3);
  }
  EXPECT_NEAR(seen(0, 0.75), 4.5, 1e-4) << "interpolated across the seam";
  EXPECT_NEAR(seen(1.0 / 16, 1), 1, 1e-4) << "and not beyond the pole";
}

TEST(EnvironmentImage, OfBytesIsDecoded) {
  const TextureImage image{1, 1, std::vector<std::uint8_t>{255, 188, 0}};
  const Rgb seen = Environment(Rgb::gray(4), std::make_shared<TextureImage>(image), 0).radiance({0, 0, 1});
  EXPECT_FLOAT_EQ(seen.r, 4);
  EXPECT_NEAR(seen.g, 4 * 0.5029, 1e-3);
  EXPECT_EQ(seen.b, 0);
}

}  // namespace
}  // namespace tessera::core::lights
