// SPDX-License-Identifier: Apache-2.0
#include "core/materials/hair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/math/bessel.hpp"
#include "core/sampling/warp.hpp"
#include "core/shading/hair_bsdf.hpp"
#include "tests/unit/core_materials/bsdf_cases.hpp"

namespace tessera::core {
namespace {

struct HairCase {
  float beta_m, beta_n, across;
  Vec3 wo;
};

std::vector<HairCase> hair_cases() {
  return {{0.3f, 0.3f, 0.65f, normalize(Vec3{0.3f, -0.2f, 0.9f})},
          {0.2f, 0.4f, 0.1f, normalize(Vec3{-0.5f, 0.6f, 0.6f})},
          {0.9f, 0.9f, 0.5f, normalize(Vec3{0.1f, 0.3f, 0.2f})},
          {0.4f, 0.3f, 0.98f, normalize(Vec3{-0.8f, 0, 0.5f})}};
}

using HairBsdf = shading::HairBsdfOf<float>;

HairBsdf bsdf_of(const Hair& model, float across) {
  const MaterialPoint at{{}, Vec2{0.5f, across}, true, Rgb::gray(1)};
  return HairBsdf(ModelAt<float, Hair>(&model, at));
}

HairBsdf hair_bsdf(const HairCase& one, Rgb absorption) {
  Hair model;
  model.pigment = HairPigment::kAbsorption;
  model.sigma_a.value = absorption;
  model.beta_m = one.beta_m;
  model.beta_n = one.beta_n;
  HairBsdf bsdf = bsdf_of(model, one.across);
  bsdf.orient(normalize(Vec3{1, 0.5f, 0}));
  return bsdf;
}

Vec3 on_sphere(double row, double column, int rows, int columns) {
  const double z = 1 - 2 * row / rows, phi = 2 * std::numbers::pi * column / columns;
  const double rho = std::sqrt(1 - z * z);
  return {static_cast<float>(rho * std::cos(phi)), static_cast<float>(rho * std::sin(phi)),
          static_cast<float>(z)};
}

TEST(HairBsdf, DensityAndWhiteHairIntegrateToOne) {
  constexpr int kRows = 150, kColumns = 300;
  for (const HairCase& one : hair_cases()) {
    const HairBsdf bsdf = hair_bsdf(one, {});
    double pdf = 0, value = 0;
    for (int r = 0; r < kRows; ++r)
      for (int c = 0; c < kColumns; ++c) {
        const BsdfValue v = bsdf.evaluate(one.wo, on_sphere(r + 0.5, c + 0.5, kRows, kColumns), 0);
        pdf += static_cast<double>(v.pdf) / (kRows * kColumns) * 4 * std::numbers::pi;
        value += static_cast<double>(v.value.g) / (kRows * kColumns) * 4 * std::numbers::pi;
      }
    EXPECT_NEAR(pdf, 1, 1e-2) << one.beta_m;
    EXPECT_NEAR(value, 1, 1e-2) << one.beta_m;
  }
}

// The white furnace, and with pigment the same light by samples of the hair and of the whole sphere.
TEST(HairBsdf, SamplesWhatItEvaluates) {
  constexpr int kSamples = 20000;
  for (const HairCase& one : hair_cases())
    for (const Rgb absorption : {Rgb{}, Rgb{0.4f, 0.9f, 2}}) {
      const HairBsdf bsdf = hair_bsdf(one, absorption);
      double sum = 0, sum2 = 0, even = 0, even2 = 0;
      for (int i = 0; i < kSamples; ++i) {
        const auto [u, u_lobe] = test::random_numbers(i);
        const auto sample = alone(bsdf.sample(one.wo, u, u_lobe));
        ASSERT_TRUE(sample);
        const BsdfValue again = bsdf.evaluate(one.wo, sample->wi_local, 0);
        ASSERT_NEAR(sample->pdf / again.pdf, 1, 1e-4);
        ASSERT_EQ(sample->transmitted, sample->wi_local.z < 0);
        const auto weight = static_cast<double>(sample->weight.g);
        const double of_even =
            static_cast<double>(bsdf.evaluate(one.wo, sampling::sample_sphere(u), 0).value.g) * 4 *
            std::numbers::pi;
        sum += weight, sum2 += weight * weight, even += of_even, even2 += of_even * of_even;
      }
      const auto error = [](double s, double s2) {
        return std::sqrt(std::max(s2 - s * s / kSamples, 0.0)) / kSamples;
      };
      EXPECT_NEAR(sum / kSamples, even / kSamples, 5 * (error(sum, sum2) + error(even, even2)) + 1e-3);
      if (is_black(absorption)) {
        EXPECT_NEAR(sum / kSamples, 1, 2e-3);
      }
    }
}

// Pearson's test over cells of equal solid angle.
TEST(HairBsdf, SamplesFollowTheirDensity) {
  constexpr int kRows = 12, kColumns = 16, kFine = 16, kSamples = 20000;
  for (const HairCase& one : hair_cases()) {
    const HairBsdf bsdf = hair_bsdf(one, {0.2f, 0.4f, 0.8f});
    std::vector<double> expected(kRows * kColumns), observed(kRows * kColumns);
    for (int r = 0; r < kRows * kFine; ++r)
      for (int c = 0; c < kColumns * kFine; ++c)
        expected[static_cast<std::size_t>(r / kFine * kColumns + c / kFine)] +=
            static_cast<double>(
                bsdf.evaluate(one.wo, on_sphere((r + 0.5) / kFine, (c + 0.5) / kFine, kRows, kColumns), 0)
                    .pdf) *
            kSamples * 4 * std::numbers::pi / (kRows * kColumns * kFine * kFine);
    for (int i = 0; i < kSamples; ++i) {
      const auto [u, u_lobe] = test::random_numbers(i);
      const Vec3 w = bsdf.sample(one.wo, u, u_lobe).wi_local;
      const double phi = std::atan2(static_cast<double>(w.y), static_cast<double>(w.x));
      const double turns = phi / (2 * std::numbers::pi);
      const int row = std::min(static_cast<int>((1 - static_cast<double>(w.z)) / 2 * kRows), kRows - 1);
      const int column = std::min(static_cast<int>((turns < 0 ? turns + 1 : turns) * kColumns), kColumns - 1);
      ++observed[static_cast<std::size_t>(row * kColumns + column)];
    }
    double chi2 = 0;
    int cells = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if (expected[i] < 20) continue;
      chi2 += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
      ++cells;
    }
    ASSERT_GT(cells, 5);
    EXPECT_LT(chi2, cells + 5 * std::sqrt(2.0 * cells) + 10) << cells << " cells, " << one.beta_m;
  }
}

// Of black hair only the reflection remains: it mirrors about the normal, where the ray meets the hair.
TEST(HairBsdf, BlackHairReflectsAboutItsNormal) {
  Hair model;
  model.pigment = HairPigment::kAbsorption;
  model.sigma_a.value = Rgb::gray(50);
  model.beta_m = model.beta_n = 0.05f;
  model.tilt_degrees = 0;
  // The viewer is aside of the normal by -y, and across grows along the normal times the tangent, +y.
  HairBsdf bsdf = bsdf_of(model, 0.75f);
  bsdf.orient({1, 0, 0});
  const Vec3 wo{0, -0.5f, std::sqrt(0.75f)};
  for (int i = 0; i < 200; ++i) {
    const auto [u, u_lobe] = test::random_numbers(i);
    const auto sample = alone(bsdf.sample(wo, u, u_lobe));
    ASSERT_TRUE(sample);
    EXPECT_GT(dot(sample->wi_local, Vec3{0, 0.5f, std::sqrt(0.75f)}), 0.9f);
  }
}

TEST(Hair, ColorsAndAbsorptionsAreInverse) {
  for (const float beta : {0.1f, 0.3f, 1.0f}) {
    const Rgb color{0.8f, 0.4f, 0.05f};
    const Rgb again = hair_color(hair_absorption(color, beta), beta);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(again[c], color[c], 1e-5f);
  }
  EXPECT_GT(mean(melanin_absorption(8.0f, 0.0f)), mean(melanin_absorption(1.3f, 0.0f)));
}

TEST(Bessel, IsTheSumOfItsSeries) {
  for (double x = 0; x < 60; x += 0.37) {
    double term = std::exp(-x), sum = 0;
    for (int k = 1; k < 200; ++k) {
      sum += term;
      term *= x * x / (4.0 * k * k);
    }
    EXPECT_NEAR(scaled_bessel_i0(x) / sum, 1, 5e-7) << x;
  }
}

}  // namespace
}  // namespace tessera::core
