// SPDX-License-Identifier: Apache-2.0
// What a white furnace says: no surface gives back more than it gets, and surfaces of microfacets lose no
// more than what bounces between facets, which a single reflection leaves out.
#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "core/sampling/sampler.hpp"
#include "tests/unit/core_materials/bsdf_cases.hpp"

namespace tessera::core {
namespace {

Vec3 viewer(double cos_o) {
  return {static_cast<float>(std::sqrt(1 - cos_o * cos_o)), 0, static_cast<float>(cos_o)};
}

// The share of the light from everywhere that reaches wo, largest channel. Refraction's compression of
// radiance is undone.
double albedo(const shading::Bsdf& bsdf, Vec3 wo, int samples) {
  Rgb sum{};
  for (int i = 0; i < samples; ++i) {
    const auto u = sampling::Sampler(3, 0, 0, static_cast<std::uint32_t>(i)).pad(0);
    if (const auto s = bsdf.sample(wo, {u[0], u[1]}, u[2])) sum += s->weight * (s->eta * s->eta);
  }
  return static_cast<double>(max_component(sum)) / samples;
}

CookTorrance white_metal(float roughness, Masking masking = Masking::kSmith) {
  CookTorrance model;
  model.f0.value = Rgb::gray(1);
  model.roughness = roughness;
  model.masking = masking;
  return model;
}

// GGX with correlated Smith masking that reflects everything, integrated over the facets' normals in double:
// what of the light leaves after one reflection. Formulae as in Heitz 2014.
double ggx_albedo(double roughness, double cos_o) {
  const double alpha = roughness * roughness, sin_o = std::sqrt(1 - cos_o * cos_o);
  const auto lambda = [&](double cos_w) {
    return (std::sqrt(1 + alpha * alpha * (1 / (cos_w * cos_w) - 1)) - 1) / 2;
  };
  constexpr int kSteps = 200;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      // Normals in proportion to D cos: u = tan^2 / (alpha^2 + tan^2), taken by the square root of 1 - u,
      // which smooths the pole at the horizon.
      const double root = (i + 0.5) / kSteps, u = 1 - root * root,
                   phi = std::numbers::pi * (j + 0.5) / kSteps;
      const double cos_h = root / std::sqrt(1 + (alpha * alpha - 1) * u);
      const double oh = sin_o * std::sqrt(1 - cos_h * cos_h) * std::cos(phi) + cos_o * cos_h;
      const double cos_i = 2 * oh * cos_h - cos_o;
      if (oh <= 0 || cos_i <= 0) continue;
      sum += 2 * root * oh / (cos_o * cos_h) / (1 + lambda(cos_o) + lambda(cos_i));
    }
  return sum / (kSteps * kSteps);
}

// Mean over a hemisphere of evenly arriving light.
template <typename Albedo>
double hemispherical(const Albedo& albedo_at) {
  constexpr int kSteps = 32;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += albedo_at(std::sqrt((i + 0.5) / kSteps)) / kSteps;
  return sum;
}

TEST(WhiteFurnace, MicrofacetsLoseWhatAnIndependentIntegrationSays) {
  for (const float roughness : {0.1f, 0.3f, 0.5f, 0.7f, 0.9f, 1.0f})
    for (const double cos_o : {1.0, 0.8, 0.5, 0.2, 0.05}) {
      const shading::Bsdf bsdf(test::material_of(white_metal(roughness)), {}, {}, true);
      EXPECT_NEAR(albedo(bsdf, viewer(cos_o), 16384), ggx_albedo(static_cast<double>(roughness), cos_o), 4e-3)
          << roughness << ' ' << cos_o;
    }
}

// Head-on and with alpha = 1 the integral is 1 - ln 2.
TEST(WhiteFurnace, TheRoughestMetalLosesTheLogarithmOfTwo) {
  const shading::Bsdf bsdf(test::material_of(white_metal(1)), {}, {}, true);
  EXPECT_NEAR(albedo(bsdf, viewer(1), 65536), 1 - std::log(2.0), 1e-3);
}

TEST(WhiteFurnace, NoSurfaceGains) {
  std::vector<MaterialModel> models{Lambert{{Rgb::gray(1)}}};
  for (const float roughness : {0.02f, 0.1f, 0.2f, 0.4f, 0.6f, 0.8f, 1.0f}) {
    models.push_back(white_metal(roughness));
    models.push_back(white_metal(roughness, Masking::kSchlick));
    for (const float ior : {1.1f, 1.5f, 2.4f}) models.push_back(Glass{.ior = ior, .roughness = roughness});
    for (const auto masking : {SmithMasking::kCorrelated, SmithMasking::kSeparable}) {
      const MicrofacetKind beckmann{MicrofacetDistribution::kBeckmann, masking};
      models.push_back(Glass{.roughness = roughness, .microfacets = beckmann});
      models.push_back(ConductorMaterial{.roughness = roughness, .microfacets = beckmann});
      models.push_back(Plastic{.diffuse = {Rgb::gray(1)}, .roughness = roughness, .microfacets = beckmann});
    }
  }
  for (const float exponent : {0.0f, 1.0f, 10.0f, 1000.0f}) {
    models.push_back(Phong{{Rgb::gray(0)}, {Rgb::gray(1)}, exponent});
    models.push_back(Phong{{Rgb::gray(0.5f)}, {Rgb::gray(0.5f)}, exponent, PhongLobe::kNPlus2});
  }
  for (std::size_t m = 0; m < models.size(); ++m)
    for (const bool outside : {true, false})
      for (const double cos_o : {1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 0.02})
        EXPECT_LE(albedo(shading::Bsdf(test::material_of(models[m]), {}, {}, outside), viewer(cos_o), 8192),
                  1.003)
            << "model " << m << ", cosine " << cos_o;
}

// Where textures make them add up to more than 1, both parts are scaled.
TEST(WhiteFurnace, NoSurfaceGainsByTwoTextures) {
  const TextureImage white{1, 1, std::vector<float>{1, 1, 1}};
  const std::vector<Texture> textures{{.image = std::make_shared<TextureImage>(white)}};
  const ColorParameter textured{Rgb::gray(1), 0};
  const shading::Bsdf phong(test::material_of(Phong{.diffuse = textured, .specular = textured}), textures, {},
                            true);
  EXPECT_LE(albedo(phong, viewer(0.8), 4096), 1.001);
  CookTorrance metal = white_metal(0.3f);
  metal.diffuse = metal.specular = textured;
  EXPECT_LE(albedo(shading::Bsdf(test::material_of(metal), textures, {}, true), viewer(0.8), 4096), 1.001);
}

// A row of the table of losses in docs/materials.md: roughness, then losses in percent.
struct Losses {
  double roughness, metal_head_on, metal_grazing, metal_mean, glass_mean, diamond_mean;
};

std::vector<Losses> published_losses() {
  std::ifstream file(TESSERA_SOURCE_DIR "/docs/materials.md");
  std::vector<Losses> rows;
  bool in_table = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| roughness |")) in_table = true;
    if (!line.starts_with("|")) in_table = false;
    if (!in_table || !(line.starts_with("| 0.") || line.starts_with("| 1"))) continue;
    for (char& c : line)
      if (c == '|' || c == '%') c = ' ';
    std::istringstream words(line);
    Losses row{};
    words >> row.roughness >> row.metal_head_on >> row.metal_grazing >> row.metal_mean >> row.glass_mean >>
        row.diamond_mean;
    EXPECT_TRUE(words) << line;
    rows.push_back(row);
  }
  return rows;
}

double glass_loss(double ior, double roughness) {
  const Glass glass{.ior = static_cast<float>(ior), .roughness = static_cast<float>(roughness)};
  const shading::Bsdf bsdf(test::material_of(glass), {}, {}, true);
  return 100 * (1 - hemispherical([&](double cos_o) { return albedo(bsdf, viewer(cos_o), 8192); }));
}

TEST(WhiteFurnace, LossesAreThoseThatTheDocumentsTell) {
  const auto rows = published_losses();
  EXPECT_EQ(rows.size(), 10u);
  for (const Losses& row : rows) {
    const auto metal = [&](double cos_o) { return ggx_albedo(row.roughness, cos_o); };
    SCOPED_TRACE(row.roughness);
    EXPECT_NEAR(row.metal_head_on, 100 * (1 - metal(1)), 0.15);
    EXPECT_NEAR(row.metal_grazing, 100 * (1 - metal(0.1)), 0.15);
    EXPECT_NEAR(row.metal_mean, 100 * (1 - hemispherical(metal)), 0.15);
    EXPECT_NEAR(row.glass_mean, glass_loss(1.5, row.roughness), 0.15);
    EXPECT_NEAR(row.diamond_mean, glass_loss(2.4, row.roughness), 0.15);
  }
}

}  // namespace
}  // namespace tessera::core
