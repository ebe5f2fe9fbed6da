// SPDX-License-Identifier: Apache-2.0
// Disney's BSDF by the formulae of Burley 2012 and 2015, and by models that it contains.
#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <vector>

#include "tests/unit/core_materials/bsdf_cases.hpp"

namespace tessera::core {
namespace {

shading::Bsdf disney_bsdf(const Disney& model, bool outside = true) {
  return shading::Bsdf(test::material_of(model), {}, {}, outside);
}

Vec3 at_angle(double cosine, double azimuth) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {static_cast<float>(sine * std::cos(azimuth)), static_cast<float>(sine * std::sin(azimuth)),
          static_cast<float>(cosine)};
}

// Directions above the surface.
std::vector<Vec3> directions() {
  std::vector<Vec3> all;
  for (const double cosine : {0.98, 0.7, 0.3, 0.1})
    for (const double azimuth : {0.3, 1.9, 4.0}) all.push_back(at_angle(cosine, azimuth));
  return all;
}

// Without a boundary, only diffuse reflection is left.
Disney matt() {
  Disney model;
  model.base_color.value = {0.2f, 0.6f, 0.9f};
  model.ior = 1;
  return model;
}

double fifth(double x) {
  return std::pow(x, 5);
}

TEST(DisneyBsdf, DiffuseReflectionIsBurleys) {
  for (const float roughness : {0.0f, 0.3f, 1.0f})
    for (const float flatness : {0.0f, 0.4f}) {
      Disney model = matt();
      model.roughness = roughness;
      model.flatness = flatness;
      for (const Vec3 wo : directions())
        for (const Vec3 wi : directions()) {
          const double o = static_cast<double>(wo.z), i = static_cast<double>(wi.z);
          const double d = static_cast<double>(dot(wo, normalize(wo + wi)));
          const double fo = fifth(1 - o), fi = fifth(1 - i),
                       retro = 2 * static_cast<double>(roughness) * d * d;
          const double diffuse = (1 - fo / 2) * (1 - fi / 2) + retro * (fo + fi + fo * fi * (retro - 1));
          const double ss = (1 + (retro / 2 - 1) * fo) * (1 + (retro / 2 - 1) * fi);
          const double flat = 1.25 * (ss * (1 / (o + i) - 0.5) + 0.5);
          const double expected =
              0.6 / std::numbers::pi * i * (diffuse + (flat - diffuse) * static_cast<double>(flatness));
          EXPECT_NEAR(disney_bsdf(model).evaluate(wo, wi).value.g, expected, 1e-5 * expected + 1e-6);
        }
    }
}

TEST(DisneyBsdf, SheenIsAddedToOpaqueSurfaces) {
  Disney model = matt();
  model.base_color.value = Rgb::gray(0);
  model.sheen = 0.5f;
  model.metallic = 0.2f;
  for (const Vec3 wo : directions())
    for (const Vec3 wi : directions()) {
      // A black metal reflects at grazing angles; it is taken off.
      Disney bare = model;
      bare.sheen = 0;
      const double sheen = static_cast<double>(disney_bsdf(model).evaluate(wo, wi).value.r -
                                               disney_bsdf(bare).evaluate(wo, wi).value.r);
      const double expected =
          0.4 * fifth(1 - static_cast<double>(dot(wo, normalize(wo + wi)))) * static_cast<double>(wi.z);
      EXPECT_NEAR(sheen, expected, 1e-4 * expected + 1e-4);
    }
}

TEST(DisneyBsdf, MetalIsThatOfConductors) {
  Disney model;
  model.metallic = 1;
  model.base_color.value = Rgb::gray(1);
  model.roughness = 0.6f;
  ConductorMaterial mirror;  // reflects everything
  mirror.roughness = 0.6f;
  mirror.microfacets = {MicrofacetDistribution::kGgx, SmithMasking::kSeparable};
  const shading::Bsdf same(test::material_of(mirror), {}, {}, true);
  for (const Vec3 wo : directions())
    for (const Vec3 wi : directions()) {
      const float expected = same.evaluate(wo, wi).value.g;
      EXPECT_NEAR(disney_bsdf(model).evaluate(wo, wi).value.g, expected, 2e-3f * expected + 1e-6f);
    }
}

TEST(DisneyBsdf, ClearGlassIsRoughGlass) {
  Disney model;
  model.specular_transmission = 1;
  model.base_color.value = Rgb::gray(1);
  model.roughness = 0.6f;
  model.sheen = 0.7f;  // which a solid has on its outside only
  Glass glass{.ior = 1.5f, .roughness = 0.6f};
  glass.microfacets = {MicrofacetDistribution::kGgx, SmithMasking::kSeparable};
  const shading::Bsdf inside(test::material_of(glass), {}, {}, false);
  model.clearcoat = 1;
  for (const Vec3 wo : directions())
    for (const Vec3 above : directions())
      for (const Vec3 wi : {above, Vec3{above.x, above.y, -above.z}}) {
        const float expected = inside.evaluate(wo, wi).value.g;
        EXPECT_NEAR(disney_bsdf(model, false).evaluate(wo, wi).value.g, expected, 2e-3f * expected + 1e-6f);
      }
}

TEST(DisneyBsdf, TransmissionIsReciprocalButForTheSquaredIndex) {
  Disney model;
  model.specular_transmission = 0.8f;
  model.metallic = 0.3f;
  model.anisotropic = 0.6f;
  model.base_color.value = {0.3f, 0.6f, 0.9f};
  for (const Vec3 a : directions())
    for (const Vec3 b : directions()) {
      const float there = disney_bsdf(model).evaluate(a, {b.x, b.y, -b.z}).value.g / b.z;
      const float back = disney_bsdf(model, false).evaluate(b, {a.x, a.y, -a.z}).value.g / a.z;
      EXPECT_NEAR(there * 2.25f, back, 2e-3f * back + 5e-4f);
    }
}

// Head-on, the density of the normals is the distribution's peak.
TEST(DisneyBsdf, ClearcoatPeaksAsGtr1) {
  for (const double gloss : {0.0, 0.5}) {
    Disney model = matt();
    model.base_color.value = Rgb::gray(0);
    model.clearcoat = 0.8f;
    model.clearcoat_gloss = static_cast<float>(gloss);
    const double alpha2 = std::pow(0.1 - 0.099 * gloss, 2);
    const double peak = (alpha2 - 1) / (std::numbers::pi * std::log(alpha2) * alpha2);
    EXPECT_NEAR(disney_bsdf(model).evaluate({0, 0, 1}, {0, 0, 1}).value.r, 0.8 * 0.25 * 0.04 * peak,
                1e-4 * peak);
  }
}

TEST(DisneyBsdf, TheSheetTransmitsDiffuseLightEvenly) {
  Disney model = matt();
  model.thin_walled = true;
  model.diffuse_transmission = 0.25f;
  model.metallic = 1;  // which sheets do not have
  model.clearcoat = 1;
  const Rgb through = disney_bsdf(model).evaluate({0.6f, 0, 0.8f}, {0, 0.8f, -0.6f}).value;
  EXPECT_NEAR(through.g, 0.25 * 0.6 / std::numbers::pi * 0.6, 1e-6);
  EXPECT_NEAR(disney_bsdf(model).evaluate({0, 0, 1}, {0, 0, 1}).value.g, 0.75 * 0.6 / std::numbers::pi, 1e-6);
  EXPECT_TRUE(disney_bsdf(model, false).transmits());
}

// A surface that does not transmit light has two fronts.
TEST(DisneyBsdf, OpaqueSurfacesAreTheSameOnBothSides) {
  Disney model;
  model.clearcoat = 0.5f;
  const Vec3 wo = directions()[3], wi = directions()[5];
  EXPECT_EQ(disney_bsdf(model).evaluate(wo, wi).value, disney_bsdf(model, false).evaluate(wo, wi).value);
}

// The longer side of the highlight lies along increasing u.
TEST(DisneyBsdf, AnisotropyFollowsTheTangent) {
  Disney model;
  model.anisotropic = 0.9f;
  shading::Bsdf along = disney_bsdf(model), across = disney_bsdf(model);
  across.orient({0, 1, 0});
  const Vec3 wi = at_angle(0.8, 0);
  EXPECT_GT(along.evaluate({0, 0, 1}, wi).value.r, 1.1f * across.evaluate({0, 0, 1}, wi).value.r);
}

}  // namespace
}  // namespace tessera::core
