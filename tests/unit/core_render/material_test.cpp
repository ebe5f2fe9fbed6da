#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/materials/bsdf.hpp"
#include "core/materials/fresnel.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
namespace {

Bsdf make(MaterialModel model, bool outside = true) {
  return Bsdf(Material{.name = "", .model = std::move(model)}, {}, {}, outside);
}

// Pearson's test of a sampler against its density, over cells of equal solid angle of the whole sphere. The
// bound is the 1e-6 quantile of chi-square by Wilson and Hilferty's approximation.
void expect_sampler_matches_pdf(const Bsdf& bsdf, Vec3 wo) {
  constexpr int kRows = 16, kColumns = 24, kSamples = 200000, kFine = 8;
  std::vector<double> observed(kRows * kColumns), expected(kRows * kColumns);
  for (int i = 0; i < kSamples; ++i) {
    const auto u = Sampler(1, i, 0, 0).pad(0);
    const auto sample = bsdf.sample(wo, {u[0], u[1]}, u[2]);
    if (!sample) continue;
    const Vec3 w = sample->wi_local;
    ASSERT_NEAR(sample->pdf, bsdf.pdf(wo, w), 1e-4 * static_cast<double>(sample->pdf));
    const double row = (1 - static_cast<double>(w.z)) / 2 * kRows;
    const double column = (std::atan2(w.y, w.x) / (2 * kPi) + 0.5f) * kColumns;
    observed[static_cast<std::size_t>(std::min(kRows - 1, static_cast<int>(row)) * kColumns +
                                      std::min(kColumns - 1, static_cast<int>(column)))] += 1;
  }
  for (int r = 0; r < kRows * kFine; ++r)
    for (int c = 0; c < kColumns * kFine; ++c) {
      const float z = 1 - 2 * (static_cast<float>(r) + 0.5f) / (kRows * kFine);
      const float phi = 2 * kPi * ((static_cast<float>(c) + 0.5f) / (kColumns * kFine) - 0.5f);
      const float rho = std::sqrt(1 - z * z);
      const double pdf = static_cast<double>(bsdf.pdf(wo, {rho * std::cos(phi), rho * std::sin(phi), z}));
      expected[static_cast<std::size_t>(r / kFine * kColumns + c / kFine)] +=
          pdf * 4 * 3.14159265358979 / (kRows * kColumns * kFine * kFine) * kSamples;
    }
  double chi2 = 0;
  int cells = 0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] < 5) {
      ASSERT_LE(observed[i], 25) << "samples where the density says there are none";
      continue;
    }
    chi2 += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
    ++cells;
  }
  ASSERT_GT(cells, 50);
  const double k = cells - 1, z = 4.75, t = 1 - 2 / (9 * k) + z * std::sqrt(2 / (9 * k));
  EXPECT_LT(chi2, k * t * t * t);
}

TEST(LambertBsdf, SamplerMatchesItsDensity) {
  for (const Vec3 wo : {Vec3{0, 0, 1}, normalize({1, 0.3f, 0.2f}), normalize({0, -1, 0.01f})})
    expect_sampler_matches_pdf(make(test::lambert(0.8f)), wo);
}

TEST(LambertBsdf, IsReciprocalAndConservesEnergy) {
  const Bsdf bsdf = make(test::lambert(0.8f));
  const Vec3 a = normalize({1, 2, 3}), b = normalize({-2, 0.5f, 1});
  EXPECT_NEAR(bsdf.evaluate(a, b).g / b.z, bsdf.evaluate(b, a).g / a.z, 1e-6);
  double albedo = 0;
  for (int i = 0; i < 10000; ++i) {
    const auto u = Sampler(1, i, 0, 0).pad(0);
    const Vec3 wi = sample_sphere({u[0], u[1]});
    albedo += static_cast<double>(bsdf.evaluate(a, wi).r) * 4 * 3.14159265358979 / 10000;
  }
  EXPECT_NEAR(albedo, 0.8, 0.02);
}

TEST(Fresnel, HasItsKnownValues) {
  EXPECT_FLOAT_EQ(fresnel_dielectric(1, 1.5f), 0.04f);
  EXPECT_FLOAT_EQ(fresnel_dielectric(1, 1 / 1.5f), 0.04f);
  EXPECT_NEAR(fresnel_dielectric(0, 1.5f), 1, 1e-6);
  EXPECT_EQ(fresnel_dielectric(0.2f, 1 / 1.5f), 1) << "beyond the critical angle";
  // Brewster's angle: tan = eta; what is reflected is all perpendicular, half of ((1 - eta^2) / (1 +
  // eta^2))^2.
  const float cos_brewster = 1 / std::sqrt(1 + 1.5f * 1.5f);
  EXPECT_NEAR(fresnel_dielectric(cos_brewster, 1.5f), 0.5 * std::pow((1 - 2.25) / (1 + 2.25), 2), 1e-6);
}

TEST(Fresnel, RefractionObeysSnell) {
  for (const float eta : {1.33f, 1.5f, 1 / 1.5f}) {
    const Vec3 w = normalize({0.3f, -0.2f, 1});
    const auto t = refract(w, {0, 0, 1}, eta);
    ASSERT_TRUE(t);
    EXPECT_NEAR(length(*t), 1, 1e-6);
    EXPECT_NEAR(std::hypot(w.x, w.y), eta * std::hypot(t->x, t->y), 1e-6);
    EXPECT_LT(t->z, 0);
    EXPECT_LT(t->x * w.x + t->y * w.y, 0);
  }
}

TEST(GlassBsdf, ChoosesByFresnelAndScalesRadianceByTheSquaredIndex) {
  const Bsdf bsdf = make(Glass{.ior = 1.5f});
  const Vec3 wo{0, 0, 1};
  const auto reflected = bsdf.sample(wo, {}, 0.039f), refracted = bsdf.sample(wo, {}, 0.041f);
  ASSERT_TRUE(reflected && refracted);
  EXPECT_FALSE(reflected->transmitted);
  EXPECT_EQ(reflected->weight, Rgb::gray(1));
  EXPECT_TRUE(refracted->transmitted);
  EXPECT_EQ(refracted->eta, 1.5f);
  EXPECT_FLOAT_EQ(refracted->weight.r, 1 / 2.25f);
  EXPECT_FLOAT_EQ(make(Glass{.ior = 1.5f}, false).sample(wo, {}, 0.9f)->weight.r, 2.25f);
}

TEST(GlassBsdf, ReflectsTotallyFromInside) {
  const Vec3 wo = normalize({1, 0, 0.2f});
  const auto sample = make(Glass{.ior = 1.5f}, false).sample(wo, {}, 0.999f);
  ASSERT_TRUE(sample);
  EXPECT_FALSE(sample->transmitted);
  EXPECT_FLOAT_EQ(sample->wi_local.x, -wo.x);
}

TEST(MirrorBsdf, ReflectsAndTints) {
  const auto sample = make(Mirror{{{0.9f, 0.5f, 0.1f}, -1}}).sample(normalize({1, 0, 1}), {}, 0);
  ASSERT_TRUE(sample);
  EXPECT_TRUE(sample->delta);
  EXPECT_EQ(sample->weight, (Rgb{0.9f, 0.5f, 0.1f}));
  EXPECT_LT(length(sample->wi_local - normalize({-1, 0, 1})), 1e-6f);
}

}  // namespace
}  // namespace tessera::core
