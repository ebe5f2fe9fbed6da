// SPDX-License-Identifier: Apache-2.0
// Samplers against their densities.
#include <gtest/gtest.h>
#include <numbers>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/math/frame.hpp"
#include "tests/unit/core_materials/bsdf_cases.hpp"

namespace tessera::core {
namespace {

constexpr int kSamples = 100000;

// Cells of equal solid angle that cover the sphere, around a pole that none of the viewers' lobes is near.
constexpr int kRows = 16, kColumns = 24;

const Frame kCells = Frame::around(normalize(Vec3{0.5f, 0.866f, 0}));

std::size_t cell_of(Vec3 direction) {
  const Vec3 w = kCells.to_local(direction);
  const int row = static_cast<int>((1 - static_cast<double>(w.z)) / 2 * kRows);
  const int column = static_cast<int>((std::atan2(w.y, w.x) / (2 * kPi) + 0.5f) * kColumns);
  return static_cast<std::size_t>(std::clamp(row, 0, kRows - 1) * kColumns +
                                  std::clamp(column, 0, kColumns - 1));
}

Vec3 direction(double row, double column) {
  const double z = 1 - 2 * row / kRows, phi = 2 * std::numbers::pi * (column / kColumns - 0.5);
  const double rho = std::sqrt(1 - z * z);
  return kCells.to_world({static_cast<float>(rho * std::cos(phi)), static_cast<float>(rho * std::sin(phi)),
                          static_cast<float>(z)});
}

// How many of the samples fall into a cell by the density, from its values at steps * steps places.
double expected_count(const shading::Bsdf& bsdf, Vec3 wo, int row, int column, int steps) {
  double sum = 0;
  for (int r = 0; r < steps; ++r)
    for (int c = 0; c < steps; ++c) {
      const Vec3 wi = direction(row + (r + 0.5) / steps, column + (c + 0.5) / steps);
      sum += static_cast<double>(bsdf.evaluate(wo, wi).pdf);
    }
  return sum * kSamples * 4 * std::numbers::pi / (kRows * kColumns * steps * steps);
}

// The same with as many places as it takes: where two coarse grids differ by more than a small part of the
// counts' standard deviation, a fine one decides.
double expected_count(const shading::Bsdf& bsdf, Vec3 wo, int row, int column) {
  constexpr int kCoarse = 5, kMedium = 8, kFine = 40;
  constexpr double kDeviations = 0.02;
  const double coarse = expected_count(bsdf, wo, row, column, kCoarse);
  const double medium = expected_count(bsdf, wo, row, column, kMedium);
  if (std::fabs(medium - coarse) <= kDeviations * std::sqrt(std::max(1.0, std::min(coarse, medium))))
    return medium;
  return expected_count(bsdf, wo, row, column, kFine);
}

// Of all cells; the last entry is for no sample at all.
std::vector<double> expected_counts(const shading::Bsdf& bsdf, Vec3 wo) {
  std::vector<double> counts;
  double sum = 0;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      counts.push_back(expected_count(bsdf, wo, row, column));
      sum += counts.back();
    }
  counts.push_back(kSamples - sum);
  return counts;
}

std::vector<double> observed_counts(const shading::Bsdf& bsdf, Vec3 wo) {
  std::vector<double> counts(kRows * kColumns + 1);
  for (int i = 0; i < kSamples; ++i) {
    const auto [u, u_lobe] = test::random_numbers(i);
    const auto sample = bsdf.sample(wo, u, u_lobe);
    ++(sample ? counts[cell_of(sample->wi_local)] : counts.back());
  }
  return counts;
}

double normal_quantile(double p) {
  double low = -10, high = 10;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (std::erfc(-middle / std::sqrt(2.0)) / 2 < p ? low : high) = middle;
  }
  return low;
}

// Chance that all of the `tests` tests of a correct sampler pass, by Sidak's correction for their number.
constexpr double kConfidence = 0.99;

double chi_square_bound(int degrees_of_freedom, std::size_t tests) {
  const double z = normal_quantile(std::pow(kConfidence, 1.0 / static_cast<double>(tests)));
  const double k = degrees_of_freedom, t = 1 - 2 / (9 * k) + z * std::sqrt(2 / (9 * k));  // Wilson, Hilferty
  return k * t * t * t;
}

class BsdfSampling : public testing::TestWithParam<test::BsdfCase> {};

// Pearson's test; cells that expect less than ten are thrown together.
TEST_P(BsdfSampling, FollowsItsDensity) {
  const shading::Bsdf bsdf = GetParam().bsdf();
  const std::size_t tests = test::bsdf_cases().size() * test::viewers().size();
  for (const Vec3 wo : test::viewers()) {
    const auto expected = expected_counts(bsdf, wo), observed = observed_counts(bsdf, wo);
    double chi2 = 0, rest_expected = 0, rest_observed = 0;
    int cells = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if (expected[i] < 10) {
        rest_expected += expected[i];
        rest_observed += observed[i];
        continue;
      }
      chi2 += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
      ++cells;
    }
    EXPECT_NEAR(rest_observed, rest_expected, 5 * std::sqrt(std::fabs(rest_expected) + 10));
    ASSERT_GT(cells, 5);
    EXPECT_LT(chi2, chi_square_bound(cells - 1, tests)) << cells << " cells, viewer " << wo.x << ' ' << wo.z;
  }
}

TEST_P(BsdfSampling, WeighsSamplesByValueOverDensity) {
  const shading::Bsdf bsdf = GetParam().bsdf();
  for (const Vec3 wo : test::viewers())
    for (int i = 0; i < 2000; ++i) {
      const auto [u, u_lobe] = test::random_numbers(i);
      const auto sample = bsdf.sample(wo, u, u_lobe);
      if (!sample) continue;
      const Vec3 wi = sample->wi_local;
      ASSERT_NEAR(length(wi), 1, 1e-5);
      const auto [value, pdf] = bsdf.evaluate(wo, wi);
      ASSERT_NEAR(sample->pdf / pdf, 1, 5e-3);
      const Rgb weighed = sample->weight * sample->pdf;
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(weighed[c], value[c], 5e-3f * value[c] + 1e-6f);
      ASSERT_EQ(sample->transmitted, wi.z < 0);
    }
}

// Different samplers of one model have the same mean.
TEST_P(BsdfSampling, HasTheMeanOfUniformSampling) {
  test::BsdfCase uniform = GetParam();
  if (uniform.material.sampling == Sampling::kUniform) return;  // the reference
  uniform.material.sampling = Sampling::kUniform;
  const shading::Bsdf bsdf = GetParam().bsdf(), reference = uniform.bsdf();
  for (const Vec3 wo : test::viewers()) {
    double sum = 0, sum2 = 0, reference_sum = 0, reference_sum2 = 0;
    for (int i = 0; i < kSamples; ++i) {
      const auto [u, u_lobe] = test::random_numbers(i);
      const auto a = bsdf.sample(wo, u, u_lobe), b = reference.sample(wo, u, u_lobe);
      const double x = a ? static_cast<double>(a->weight.g) : 0, y = b ? static_cast<double>(b->weight.g) : 0;
      sum += x, sum2 += x * x, reference_sum += y, reference_sum2 += y * y;
    }
    const auto variance = [](double s, double s2) { return (s2 - s * s / kSamples) / kSamples / kSamples; };
    EXPECT_NEAR(sum / kSamples, reference_sum / kSamples,
                5 * std::sqrt(variance(sum, sum2) + variance(reference_sum, reference_sum2)) + 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(All, BsdfSampling, testing::ValuesIn(test::bsdf_cases()),
                         [](const auto& test_case) { return test_case.param.name; });

}  // namespace
}  // namespace tessera::core
