// SPDX-License-Identifier: Apache-2.0
// Models that scatter into single directions.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core_materials/bsdf_cases.hpp"

namespace tessera::core {
namespace {

shading::Bsdf make(MaterialModel model, bool outside = true) {
  return shading::Bsdf(test::material_of(std::move(model)), {}, {}, outside);
}

TEST(GlassBsdf, ChoosesByFresnelAndScalesRadianceByTheSquaredIndex) {
  const shading::Bsdf bsdf = make(Glass{.ior = 1.5f});
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

TEST(GlassBsdf, WithoutFresnelRefractsAllThatCanPass) {
  const Glass glass{.ior = 1.5f, .fresnel = DielectricFresnel::kNone};
  const auto passed = make(glass).sample(normalize({1, 0, 0.1f}), {}, 0);
  ASSERT_TRUE(passed);
  EXPECT_TRUE(passed->transmitted);
  const auto reflected = make(glass, false).sample(normalize({1, 0, 0.1f}), {}, 0.999f);
  ASSERT_TRUE(reflected);
  EXPECT_FALSE(reflected->transmitted);
}

TEST(GlassBsdf, IsSmoothWhereItsRoughnessIsZero) {
  const TextureImage image{2, 1, std::vector<float>{0, 0, 0, 1, 1, 1}};
  const std::vector<Texture> textures{{.image = std::make_shared<TextureImage>(image)}};
  const Material frosted = test::material_of(Glass{.roughness = {0.5f, 0}});
  EXPECT_TRUE(shading::Bsdf(frosted, textures, Vec2{0.25f, 0.5f}, true).is_delta());
  EXPECT_FALSE(shading::Bsdf(frosted, textures, Vec2{0.75f, 0.5f}, true).is_delta());
}

TEST(GlassBsdf, KeepsItsDirectionsWhenSampledUniformly) {
  const shading::Bsdf bsdf(test::material_of(Glass{}, Sampling::kUniform), {}, {}, true);
  EXPECT_TRUE(bsdf.is_delta());
  EXPECT_TRUE(bsdf.sample({0, 0, 1}, {0.3f, 0.4f}, 0.5f)->transmitted);
}

TEST(GlassBsdf, BranchesAddUpToItsSamples) {
  for (const auto fresnel :
       {DielectricFresnel::kExact, DielectricFresnel::kSchlick, DielectricFresnel::kNone}) {
    const shading::Bsdf bsdf = make(Glass{.ior = 1.5f, .fresnel = fresnel}, false);
    for (const Vec3 wo : test::viewers()) {
      double branches = 0, samples = 0;
      for (const auto& branch : bsdf.delta_branches(wo))
        if (branch) branches += static_cast<double>(branch->weight.g * branch->eta * branch->eta);
      for (int i = 0; i < 100; ++i) {
        const auto sample = bsdf.sample(wo, {}, (static_cast<float>(i) + 0.5f) / 100);
        samples += sample ? static_cast<double>(sample->weight.g * sample->eta * sample->eta) / 100 : 0;
      }
      EXPECT_NEAR(branches, samples, 1e-5);
    }
  }
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
