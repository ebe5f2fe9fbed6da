// SPDX-License-Identifier: Apache-2.0
// Distributions of microfacet normals: their normalisation, the tables made of them, and what plastic loses.
#include "core/materials/microfacets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/materials/anisotropic_ggx.hpp"
#include "core/materials/directional_albedo.hpp"
#include "core/sampling/sampler.hpp"
#include "tests/unit/core_materials/bsdf_cases.hpp"

namespace tessera::core {
namespace {

constexpr MicrofacetKind kKinds[] = {{MicrofacetDistribution::kGgx, SmithMasking::kCorrelated},
                                     {MicrofacetDistribution::kGgx, SmithMasking::kSeparable},
                                     {MicrofacetDistribution::kBeckmann, SmithMasking::kCorrelated},
                                     {MicrofacetDistribution::kBeckmann, SmithMasking::kSeparable}};

// The integral of pdf_visible over the hemisphere.
double visible_total(const Microfacets& facets, Vec3 wo) {
  constexpr int kSteps = 300;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double theta = std::numbers::pi / 2 * (i + 0.5) / kSteps, sine = std::sin(theta);
      const double phi = 2 * std::numbers::pi * (j + 0.5) / kSteps;
      const Vec3 h{static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
                   static_cast<float>(std::cos(theta))};
      sum += static_cast<double>(facets.pdf_visible(wo, h)) * sine;
    }
  return sum * std::numbers::pi * std::numbers::pi / (kSteps * kSteps);
}

// Masking is what makes the visible normals add up to all that is seen (Heitz 2014, eq. 14).
TEST(Microfacets, VisibleNormalsAddUpToOne) {
  for (const auto distribution : {MicrofacetDistribution::kGgx, MicrofacetDistribution::kBeckmann})
    for (const Vec3 wo : test::viewers()) {
      EXPECT_NEAR(visible_total(Microfacets({distribution, {}}, 0.3f, 0.8f), wo), 1, 2e-3) << wo.z;
      EXPECT_NEAR(visible_total(Microfacets({distribution, {}}, 0.2f), wo), 1, 2e-3) << wo.z;
    }
}

TEST(Microfacets, OfCorrelatedGgxAreAnisotropicGgx) {
  const AnisotropicGgx ggx(0.3f, 0.7f);
  const Microfacets facets({}, 0.3f, 0.7f);
  for (const Vec3 wo : test::viewers()) {
    const Vec3 wi = normalize(Vec3{-0.3f, 0.4f, 0.6f}), h = normalize(wo + wi);
    EXPECT_FLOAT_EQ(facets.density(h), ggx.density(h));
    EXPECT_NEAR(facets.smith_visibility(wo, wi) / ggx.smith_visibility(wo, wi), 1, 1e-5f);
    EXPECT_NEAR(facets.pdf_visible(wo, h) / ggx.pdf_visible(wo, h), 1, 1e-5f);
  }
}

// The share of the light from everywhere that facets which reflect all of it send to the viewer.
float sampled_albedo(MicrofacetKind kind, float alpha, float cos_o) {
  const Microfacets facets(kind, alpha);
  const Vec3 wo = at_cosine(cos_o);
  constexpr std::uint32_t kSamples = 16384;
  double sum = 0;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const auto u = sampling::Sampler(3, 0, 0, i).pad(0);
    const Vec3 h = facets.sample_visible(wo, {u[0], u[1]});
    const Vec3 wi = h * (2 * dot(wo, h)) - wo;
    if (wi.z <= 0) continue;
    sum += static_cast<double>(4 * cos_o * wi.z * facets.smith_visibility(wo, wi) / facets.visible(wo));
  }
  return static_cast<float>(sum / kSamples);
}

TEST(DirectionalAlbedo, IsThatOfItsKind) {
  for (const MicrofacetKind& kind : kKinds)
    for (const float root_alpha : {0.4f, 0.8f, 1.0f})
      for (const float cos_o : {1.0f, 0.36f, 0.04f})
        EXPECT_NEAR(DirectionalAlbedo::tables(kind).reflecting(cos_o, root_alpha * root_alpha),
                    sampled_albedo(kind, root_alpha * root_alpha, cos_o), 6e-3f)
            << (kind.distribution == MicrofacetDistribution::kBeckmann) << ' '
            << (kind.masking == SmithMasking::kSeparable) << ' ' << root_alpha << ' ' << cos_o;
}

// Beckmann's steep facets are fewer than those of GGX, and lose less.
TEST(DirectionalAlbedo, OfBeckmannLosesLess) {
  const auto& ggx = DirectionalAlbedo::tables();
  const auto& beckmann = DirectionalAlbedo::tables(kKinds[2]);
  EXPECT_GT(beckmann.reflecting(1, 0.5f), ggx.reflecting(1, 0.5f) + 0.01f);
  EXPECT_NEAR(beckmann.reflected(1, 0, 1.5f), 0.04f, 1.5e-3f);
  EXPECT_NEAR(beckmann.mean_scattered_inside(0, 1.5f), 1, 1e-5f);
  EXPECT_LT(beckmann.mean_scattered_inside(1, 1.5f), 0.95f);
}

// The base below rough facets is darker if what they throw to each other is lost.
TEST(Plastic, LosesLightUnlessCompensated) {
  const auto value_of = [](bool compensated, float roughness) {
    const Plastic plastic{.diffuse = {Rgb::gray(1)}, .roughness = roughness, .compensated = compensated};
    const shading::Bsdf bsdf(test::material_of(plastic), {}, {}, true);
    return bsdf.evaluate({0, 0, 1}, normalize(Vec3{1, 0, 0.3f})).value.g;
  };
  EXPECT_LT(value_of(false, 1), 0.97f * value_of(true, 1));
  EXPECT_NEAR(value_of(false, 0), value_of(true, 0), 1e-4f);
}

}  // namespace
}  // namespace tessera::core
