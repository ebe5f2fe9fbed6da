// SPDX-License-Identifier: Apache-2.0
// Samples of environments against their densities, and against the light that there is.
#include <gtest/gtest.h>
#include <numbers>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "core/lights/environment.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/unit/core_render/sky_image.hpp"

namespace tessera::core::lights {
namespace {

using test::sky_image;
using test::SkyImage;

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
    const auto u = sampling::Sampler(3, i % 1000, i / 1000, 0).pad(0);
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
    const auto u = sampling::Sampler(4, i, 0, 0).pad(0);
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
    const auto u = sampling::Sampler(6, i, 0, 0).pad(0);
    const Vec3 w = sampling::sample_sphere({u[0], u[1]});
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
    return normal_ == Vec3{} ? sampling::sample_sphere(u)
                             : Frame::around(normal_).to_world(sampling::sample_cosine_hemisphere(u));
  };
  const auto scattered_pdf = [&](Vec3 wi) {
    return normal_ == Vec3{} ? 1 / (4 * std::numbers::pi) : cosine(wi) / std::numbers::pi;
  };
  const auto weighed = [&](Vec3 wi) {
    const double light_pdf = static_cast<double>(environment_.pdf(normal_, wi, MisCompensation::kOn));
    return static_cast<double>(environment_.radiance(wi).g) * cosine(wi) / (light_pdf + scattered_pdf(wi));
  };
  for (int i = 0; i < kSamples; ++i) {
    const auto u = sampling::Sampler(7, i % 1000, i / 1000, 0).pad(0);
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

}  // namespace
}  // namespace tessera::core::lights
