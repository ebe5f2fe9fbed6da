// SPDX-License-Identifier: Apache-2.0
#include "core/lights/environment.hpp"

#include <gtest/gtest.h>
#include <numbers>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/lights/normal_bins.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"
#include "tests/support/chi_square.hpp"

namespace tessera::core {
namespace {

using SkyImage = std::shared_ptr<const TextureImage>;

SkyImage sky_image(int width, int height, const std::function<float(int, int)>& value) {
  std::vector<float> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) texels.insert(texels.end(), 3, value(x, y));
  return std::make_shared<TextureImage>(TextureImage{width, height, std::move(texels)});
}

struct EnvironmentCase {
  const char* name;
  SkyImage image;
  float rotation = 0;
  int least_cells = 50;  // that samples fall into
};

struct LitCase {
  const char* name;
  Vec3 normal;
};

class EnvironmentSampling : public testing::TestWithParam<std::tuple<EnvironmentCase, LitCase>> {
 protected:
  void expect_samples_match_density(MisCompensation compensation, int least_cells) const;
  const EnvironmentCase& surroundings() const { return std::get<0>(GetParam()); }
  // What light from a direction counts for.
  double cosine(Vec3 direction) const {
    return normal_ == Vec3{} ? 1 : std::max(0.0, static_cast<double>(dot(normal_, direction)));
  }

  Environment environment_{Rgb::gray(2), surroundings().image, surroundings().rotation};
  Vec3 normal_ = std::get<1>(GetParam()).normal;
};

// Pearson's test with the image's texels for cells, or parts of them, on each quarter of which the density
// is even, or bilinear but for a cosine of the latitude that it is divided by. Samples of black directions
// are not answered; light begins and ends half way between texels' edges.
void EnvironmentSampling::expect_samples_match_density(MisCompensation compensation, int least_cells) const {
  constexpr int kSamples = 200000;
  const auto at_least = [](int texels, int least) { return texels * ((least + texels - 1) / texels); };
  const SkyImage& image = surroundings().image;
  const int width = at_least(image ? image->width() : 1, 32),
            height = at_least(image ? image->height() : 1, 16);
  const double rotation = static_cast<double>(surroundings().rotation) * std::numbers::pi / 180;
  std::vector<double> observed(static_cast<std::size_t>(width * height)), expected(observed.size());
  for (int i = 0; i < kSamples; ++i) {
    const auto u = Sampler(3, i % 1000, i / 1000, 0).pad(0);
    const auto s = environment_.sample(normal_, {u[0], u[1]}, compensation);
    if (!s) continue;
    const double turn = (std::atan2(static_cast<double>(s->wi.x), static_cast<double>(-s->wi.z)) + rotation) /
                        (2 * std::numbers::pi);
    const double column = (turn + 0.5 - std::floor(turn + 0.5)) * width;
    const double row = std::acos(static_cast<double>(s->wi.y)) / std::numbers::pi * height;
    observed[static_cast<std::size_t>(std::min(static_cast<int>(row), height - 1) * width +
                                      std::min(static_cast<int>(column), width - 1))] += 1;
  }
  for (int y = 0; y < 2 * height; ++y)
    for (int x = 0; x < 2 * width; ++x) {
      const double above = std::numbers::pi * y / (2 * height),
                   below = std::numbers::pi * (y + 1) / (2 * height);
      const double phi = 2 * std::numbers::pi * ((x + 0.5) / (2 * width) - 0.5) - rotation,
                   theta = (above + below) / 2;
      const Vec3 w{static_cast<float>(std::sin(theta) * std::sin(phi)), static_cast<float>(std::cos(theta)),
                   static_cast<float>(-std::sin(theta) * std::cos(phi))};
      if (is_black(environment_.radiance(w))) continue;
      const double solid_angle = 2 * std::numbers::pi / (2 * width) * (std::cos(above) - std::cos(below));
      expected[static_cast<std::size_t>(y / 2 * width + x / 2)] +=
          static_cast<double>(environment_.pdf(normal_, w, compensation)) * solid_angle * kSamples;
    }
  test::expect_chi_square(observed, expected, least_cells);
}

TEST_P(EnvironmentSampling, SamplesMatchTheDensity) {
  expect_samples_match_density(MisCompensation::kOff, surroundings().least_cells);
}

TEST_P(EnvironmentSampling, CompensatedSamplesMatchTheDensity) {
  expect_samples_match_density(MisCompensation::kOn, 4);
}

// All but the few samples that rounding puts across the edge of a cell, and those right beside a pole, of
// whose distance rounding leaves little.
TEST_P(EnvironmentSampling, SampleAndPdfAgree) {
  constexpr int kSamples = 50000;
  int differing = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto compensation = i % 2 == 0 ? MisCompensation::kOff : MisCompensation::kOn;
    const auto u = Sampler(4, i, 0, 0).pad(0);
    const auto s = environment_.sample(normal_, {u[0], u[1]}, compensation);
    if (!s) continue;
    const auto pdf = static_cast<double>(s->pdf);
    const auto of_wi = static_cast<double>(environment_.pdf(normal_, s->wi, compensation));
    differing += std::fabs(of_wi - pdf) > 1e-4 * pdf ? 1 : 0;
    ASSERT_EQ(s->radiance, environment_.radiance(s->wi)) << "of a unit direction, as rays look it up";
    ASSERT_FALSE(s->point);
    ASSERT_FALSE(s->delta);
  }
  EXPECT_LE(differing, kSamples / 250);
}

TEST_P(EnvironmentSampling, DensityIsThereWhereverThereIsLight) {
  for (int i = 0; i < 200000; ++i) {
    const auto u = Sampler(6, i, 0, 0).pad(0);
    const Vec3 w = sample_sphere({u[0], u[1]});
    if (is_black(environment_.radiance(w))) continue;
    ASSERT_GT(environment_.pdf(normal_, w), 0);
  }
}

// The integral of radiance times the cosine: by light samples, by compensated ones combined with those of a
// diffuse surface, by the midpoint rule; and about what the power says.
TEST_P(EnvironmentSampling, FindsTheLightThatThereIs) {
  constexpr int kSamples = 100000, kRows = 1000, kColumns = 1000;
  double sampled = 0, combined = 0, looked = 0, over_sphere = 0;
  const auto scattered = [&](Vec2 u) {
    return normal_ == Vec3{} ? sample_sphere(u)
                             : Frame::around(normal_).to_world(sample_cosine_hemisphere(u));
  };
  const auto scattered_pdf = [&](Vec3 wi) {
    return normal_ == Vec3{} ? 1 / (4 * std::numbers::pi) : cosine(wi) / std::numbers::pi;
  };
  const auto weighed = [&](Vec3 wi) {
    const double light_pdf = static_cast<double>(environment_.pdf(normal_, wi, MisCompensation::kOn));
    return static_cast<double>(environment_.radiance(wi).g) * cosine(wi) / (light_pdf + scattered_pdf(wi));
  };
  for (int i = 0; i < kSamples; ++i) {
    const auto u = Sampler(7, i % 1000, i / 1000, 0).pad(0);
    if (const auto s = environment_.sample(normal_, {u[0], u[1]}))
      sampled += static_cast<double>(s->radiance.g / s->pdf) * cosine(s->wi) / kSamples;
    if (const auto s = environment_.sample(normal_, {u[0], u[1]}, MisCompensation::kOn);
        s && scattered_pdf(s->wi) > 0)
      combined += weighed(s->wi) / kSamples;
    const Vec3 wi = scattered({u[2], u[3]});
    if (scattered_pdf(wi) > 0) combined += weighed(wi) / kSamples;
  }
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const double y = 1 - 2 * (row + 0.5) / kRows, rho = std::sqrt(1 - y * y);
      const double phi = 2 * std::numbers::pi * (column + 0.5) / kColumns;
      const Vec3 w{static_cast<float>(rho * std::cos(phi)), static_cast<float>(y),
                   static_cast<float>(rho * std::sin(phi))};
      const double light =
          static_cast<double>(environment_.radiance(w).g) * 4 * std::numbers::pi / (double{kRows} * kColumns);
      looked += light * cosine(w);
      over_sphere += light;
    }
  EXPECT_NEAR(sampled, looked, 0.01 * looked + 1e-4 * over_sphere);
  EXPECT_NEAR(combined, looked, 0.01 * looked + 1e-4 * over_sphere);
  EXPECT_NEAR(environment_.power(1) / std::numbers::pi, over_sphere, 0.1 * over_sphere);
}

INSTANTIATE_TEST_SUITE_P(
    Images, EnvironmentSampling,
    testing::Combine(
        testing::Values(
            EnvironmentCase{"constant", nullptr, 0, 480},
            EnvironmentCase{
                "coarse",
                sky_image(8, 4, [](int x, int y) { return static_cast<float>((x * 5 + y * 3) % 7); }), 0, 30},
            EnvironmentCase{
                "coarse_turned",
                sky_image(8, 4, [](int x, int y) { return static_cast<float>((x * 5 + y * 3) % 7); }), 77,
                30},
            EnvironmentCase{"odd_sides",
                            sky_image(101, 53,
                                      [](int x, int y) {
                                        if (x > 30 && x < 40) return 0.0f;
                                        return x == 60 && y == 41 ? 300.0f : static_cast<float>((x * y) % 5);
                                      }),
                            130, 1000},
            EnvironmentCase{"a_column",
                            sky_image(1, 40, [](int, int y) { return static_cast<float>(y % 9); }), 0, 100},
            EnvironmentCase{"a_row", sky_image(40, 1, [](int x, int) { return static_cast<float>(x % 7); }),
                            0, 100},
            EnvironmentCase{
                "large_and_uneven",
                sky_image(512, 256, [](int x, int y) { return (x / 16 + y / 16) % 3 == 0 ? 4.0f : 0.25f; }),
                0, 1000},
            EnvironmentCase{"black_above", sky_image(16, 9, [](int, int y) { return y < 5 ? 0.0f : 1.0f; }),
                            0, 80},
            EnvironmentCase{
                "one_bright_texel",
                sky_image(64, 32, [](int x, int y) { return x == 20 && y == 9 ? 1000.0f : 0.0f; }), -200, 9},
            EnvironmentCase{"bright_pole",
                            sky_image(32, 16, [](int x, int y) { return y == 0 && x == 3 ? 500.0f : 0.1f; })},
            EnvironmentCase{
                "suns_at_both_poles",
                sky_image(128, 64, [](int x, int y) { return y % 63 == 0 && x == 3 ? 500.0f : 0.1f; })},
            EnvironmentCase{"across_the_seam",
                            sky_image(32, 16, [](int x, int y) { return x == 0 && y == 8 ? 100.0f : 0.01f; }),
                            15}),
        testing::Values(LitCase{"from_all_sides", {}}, LitCase{"from_above", {0, 1, 0}},
                        LitCase{"aslant", {0.48f, -0.6f, 0.64f}})),
    [](const auto& test_case) {
      return std::string(std::get<0>(test_case.param).name) + "_" + std::get<1>(test_case.param).name;
    });

// Only the texel and those beside it, between which it is interpolated.
TEST(EnvironmentSampling, OneBrightTexelGetsAllSamples) {
  const Environment environment(
      Rgb::gray(1), sky_image(64, 32, [](int x, int y) { return x == 20 && y == 9 ? 1000.0f : 0.0f; }), 0);
  for (int i = 0; i < 1000; ++i) {
    const auto u = Sampler(8, i, 0, 0).pad(0);
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
    const auto u = Sampler(9, i % 1000, i / 1000, 0).pad(0);
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
      const auto u = Sampler(13, i % 1000, i / 1000, 0).pad(0);
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
    const auto u = Sampler(14, i, 0, 0).pad(0);
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
      const Vec3 normal =
          n < 6 ? Vec3{static_cast<float>(n == 0) - static_cast<float>(n == 1),
                       static_cast<float>(n == 2) - static_cast<float>(n == 3),
                       static_cast<float>(n == 4) - static_cast<float>(n == 5)}
                : sample_sphere({Sampler(11, n, 0, 0).pad(0)[0], Sampler(11, n, 0, 0).pad(0)[1]});
      int in_front = 0, high = 0;
      for (int i = 0; i < kSamples; ++i) {
        const auto u = Sampler(10, i % 100, i / 100, 0).pad(0);
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
      const auto u = Sampler(12, i, column, 0).pad(0);
      const double aside = i % 3 == 0 ? 0 : static_cast<double>(u[2]) * 1.9 - 0.95;
      const double longitude = 2 * std::numbers::pi * ((column + 0.5 + aside) / 128 - 0.5);
      const Vec3 sun{static_cast<float>(std::sin(longitude)), 0.07f,
                     static_cast<float>(-std::cos(longitude))};
      const Vec3 normal = sample_sphere({u[0], u[1]});
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
    const auto u = Sampler(15, i, 0, 0).pad(0);
    const Vec3 wi = sample_sphere({u[0], u[1]});
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
}  // namespace tessera::core
