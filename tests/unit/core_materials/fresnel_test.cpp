// SPDX-License-Identifier: Apache-2.0
// Fresnel's equations, their approximation, and the metals.
#include "core/materials/fresnel.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/materials/conductor.hpp"

namespace tessera::core {
namespace {

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

TEST(Fresnel, TheIndexFollowsFromTheReflectance) {
  for (const float ior : {1.0f, 1.33f, 1.5f, 2.5f})
    EXPECT_NEAR(index_of_reflectance(normal_reflectance(ior), 10), ior, 1e-5);
  EXPECT_EQ(index_of_reflectance(0, 10), 1);
  EXPECT_EQ(index_of_reflectance(1, 10), 10);
  EXPECT_EQ(index_of_reflectance(0.99f, 10), 10);
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

// Both ways through one boundary, the same share is reflected.
TEST(Fresnel, IsTheSameFromBothSides) {
  for (const auto fresnel : {DielectricFresnel::kExact, DielectricFresnel::kSchlick})
    for (const float cos_i : {1.0f, 0.7f, 0.3f, 0.1f}) {
      const float cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / 2.25f);
      EXPECT_NEAR(dielectric_reflectance(fresnel, cos_i, 1.5f),
                  dielectric_reflectance(fresnel, cos_t, 1 / 1.5f), 2e-6);
    }
}

TEST(SchlickFresnel, IsExactHeadOnAndNearElsewhere) {
  EXPECT_FLOAT_EQ(fresnel_dielectric_schlick(1, 1.5f), 0.04f);
  EXPECT_FLOAT_EQ(fresnel_dielectric_schlick(0, 1.5f), 1);
  EXPECT_NEAR(fresnel_dielectric_schlick(0.5f, 1.5f), 0.04 + 0.96 / 32, 1e-6);
  EXPECT_EQ(fresnel_dielectric_schlick(0.2f, 1 / 1.5f), 1) << "beyond the critical angle";
  for (int i = 0; i <= 100; ++i) {
    const float cos_i = static_cast<float>(i) / 100;
    EXPECT_NEAR(fresnel_dielectric_schlick(cos_i, 1.5f), fresnel_dielectric(cos_i, 1.5f), 0.045) << cos_i;
  }
}

TEST(NoFresnel, ReflectsOnlyWhatCannotPass) {
  EXPECT_EQ(dielectric_reflectance(DielectricFresnel::kNone, 0.01f, 1.5f), 0);
  EXPECT_EQ(dielectric_reflectance(DielectricFresnel::kNone, 0.8f, 1 / 1.5f), 0);
  EXPECT_EQ(dielectric_reflectance(DielectricFresnel::kNone, 0.7f, 1 / 1.5f), 1);
}

TEST(ConductorFresnel, OfNoAbsorptionIsThatOfADielectric) {
  for (const float cos_i : {1.0f, 0.6f, 0.2f, 0.05f})
    EXPECT_NEAR(fresnel_conductor(cos_i, Rgb::gray(1.5f), {}).r, fresnel_dielectric(cos_i, 1.5f), 1e-5);
}

TEST(ConductorFresnel, IsAllAtGrazingAngles) {
  const ComplexIndex gold = complex_index(Conductor::kGold);
  EXPECT_NEAR(fresnel_conductor(0, gold.eta, gold.k).b, 1, 1e-6);
}

// ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2) head-on, computed apart from the fitted indices
// (conductor_test.cpp has the published ones).
TEST(Conductors, ReflectHeadOnWhatTheirIndicesSay) {
  const auto expect_reflectance = [](Conductor conductor, double r, double g, double b) {
    const ComplexIndex index = complex_index(conductor);
    const Rgb reflected = fresnel_conductor(1, index.eta, index.k);
    EXPECT_NEAR(reflected.r, r, 5e-4);
    EXPECT_NEAR(reflected.g, g, 5e-4);
    EXPECT_NEAR(reflected.b, b, 5e-4);
  };
  expect_reflectance(Conductor::kCopper, 0.9317, 0.6227, 0.5224);
  expect_reflectance(Conductor::kGold, 0.9980, 0.7283, 0.3647);
  expect_reflectance(Conductor::kSilver, 0.9893, 0.9840, 0.9778);
  expect_reflectance(Conductor::kAluminium, 0.9074, 0.9158, 0.9223);
}

}  // namespace
}  // namespace tessera::core
