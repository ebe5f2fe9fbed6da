// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_materials/bsdf_cases.hpp"

#include <utility>

#include "core/sampling/sampler.hpp"

namespace tessera::core::test {
namespace {

CookTorrance metal(Conductor conductor, float roughness, Masking masking) {
  CookTorrance model;
  model.conductor = conductor;
  model.roughness = roughness;
  model.masking = masking;
  return model;
}

// Nothing but the highlight, so that no matt part hides its mistakes.
Phong highlight(float exponent) {
  Phong model;
  model.diffuse.value = {};
  model.specular.value = Rgb::gray(1);
  model.exponent = exponent;
  return model;
}

CookTorrance lacquer() {
  CookTorrance model;
  model.diffuse.value = {0.5f, 0.2f, 0.1f};
  model.specular.value = Rgb::gray(0.5f);
  model.roughness = 0.5f;
  return model;
}

Phong phong(float exponent, PhongLobe lobe) {
  Phong model;
  model.diffuse.value = {0.2f, 0.4f, 0.1f};
  model.specular.value = Rgb::gray(0.5f);
  model.exponent = exponent;
  model.lobe = lobe;
  return model;
}

Glass rough_glass(float ior, float roughness, DielectricFresnel fresnel) {
  Glass model;
  model.ior = ior;
  model.roughness = roughness;
  model.fresnel = fresnel;
  return model;
}

// Every layer at once.
Principled layered() {
  Principled model;
  model.base_color.value = {0.8f, 0.3f, 0.1f};
  model.base_diffuse_roughness = 0.6f;
  model.base_metalness = 0.3f;
  model.specular_roughness = 0.6f;
  model.transmission_weight = 0.4f;
  model.coat_weight = 0.7f;
  model.coat_roughness = 0.5f;
  model.fuzz_weight = 0.4f;
  return model;
}

Principled thin_walled() {
  Principled model;
  model.base_color.value = {0.2f, 0.6f, 0.1f};
  model.specular_roughness = 0.6f;
  model.transmission_weight = 0.5f;
  model.subsurface_weight = 0.5f;
  model.subsurface_scatter_anisotropy = 0.25f;
  model.geometry_thin_walled = true;
  return model;
}

Plastic rough_plastic() {
  Plastic model;
  model.diffuse.value = {0.1f, 0.5f, 0.8f};
  model.roughness = 0.5f;
  model.nonlinear = true;
  return model;
}

ConductorMaterial brushed_metal() {
  ConductorMaterial model;
  model.eta.value = {0.2f, 0.9f, 1.1f};
  model.k.value = {3.9f, 2.4f, 2.1f};
  model.roughness = 0.6f;
  model.anisotropy = 0.5f;
  return model;
}

constexpr MicrofacetKind kBeckmann{MicrofacetDistribution::kBeckmann, SmithMasking::kCorrelated};
constexpr MicrofacetKind kSeparableBeckmann{MicrofacetDistribution::kBeckmann, SmithMasking::kSeparable};

Glass beckmann_glass(float roughness, MicrofacetKind kind) {
  Glass model = rough_glass(1.5f, roughness, DielectricFresnel::kExact);
  model.microfacets = kind;
  return model;
}

Plastic beckmann_plastic() {
  Plastic model = rough_plastic();
  model.microfacets = kSeparableBeckmann;
  model.compensated = false;
  return model;
}

ConductorMaterial brushed_beckmann() {
  ConductorMaterial model = brushed_metal();
  model.microfacets = kBeckmann;
  return model;
}

// Every lobe that it has at once.
Disney disney() {
  Disney model;
  model.base_color.value = {0.2f, 0.5f, 0.7f};
  model.metallic = 0.3f;
  model.roughness = 0.6f;
  model.anisotropic = 0.7f;
  model.specular_tint = 0.5f;
  model.flatness = 0.4f;
  model.sheen = 0.8f;
  model.sheen_tint = 0.5f;
  model.clearcoat = 1;
  return model;
}

Disney clear_disney() {
  Disney model = disney();
  model.specular_transmission = 0.7f;
  return model;
}

Disney disney_sheet() {
  Disney model = clear_disney();
  model.diffuse_transmission = 0.4f;
  model.thin_walled = true;
  return model;
}

}  // namespace

std::vector<BsdfCase> bsdf_cases() {
  constexpr auto kExact = DielectricFresnel::kExact;
  const std::vector<std::pair<std::string, MaterialModel>> models{
      {"lambert", Lambert{{Rgb::gray(0.8f)}}},
      {"phong_n1", phong(40, PhongLobe::kNPlus1)},
      {"phong_n2", phong(40, PhongLobe::kNPlus2)},
      {"phong_flat", phong(0, PhongLobe::kNPlus2)},
      {"highlight_flat", highlight(0)},
      {"highlight_sharp", highlight(500)},
      {"silver", metal(Conductor::kSilver, 0.4f, Masking::kSmith)},
      {"copper_rough", metal(Conductor::kCopper, 1, Masking::kSmith)},
      {"gold_schlick", metal(Conductor::kGold, 0.6f, Masking::kSchlick)},
      {"lacquer", lacquer()},
      {"rough_glass", rough_glass(1.5f, 0.5f, kExact)},
      {"rougher_diamond", rough_glass(2.4f, 0.8f, kExact)},
      {"rough_water_schlick", rough_glass(1.33f, 0.6f, DielectricFresnel::kSchlick)},
      {"rough_glass_unreflecting", rough_glass(1.5f, 0.6f, DielectricFresnel::kNone)},
      {"beckmann_glass", beckmann_glass(0.6f, kBeckmann)}};
  std::vector<BsdfCase> cases;
  for (const auto& [name, model] : models) {
    cases.push_back({name, material_of(model)});
    cases.push_back({name + "_uniform", material_of(model, Sampling::kUniform)});
    if (std::holds_alternative<CookTorrance>(model))
      cases.push_back({name + "_half_vector", material_of(model, Sampling::kHalfVector)});
    if (std::holds_alternative<Glass>(model)) cases.push_back({name + "_inside", material_of(model), false});
  }
  cases.push_back({"layered", material_of(layered())});
  cases.push_back({"layered_inside", material_of(layered()), false});
  cases.push_back({"leaning_coat", material_of(layered()), true, leaning_frame()});
  Principled brushed = layered();
  brushed.coat_roughness_anisotropy = 0.6f;
  cases.push_back({"leaning_brushed_coat", material_of(brushed), true, leaning_frame()});
  cases.push_back({"thin_walled", material_of(thin_walled())});
  cases.push_back({"rough_plastic", material_of(rough_plastic())});
  cases.push_back({"brushed_metal", material_of(brushed_metal())});
  cases.push_back({"rougher_beckmann_glass", material_of(beckmann_glass(0.9f, kSeparableBeckmann))});
  cases.push_back({"beckmann_plastic", material_of(beckmann_plastic())});
  cases.push_back({"brushed_beckmann", material_of(brushed_beckmann())});
  cases.push_back({"disney", material_of(disney())});
  cases.push_back({"clear_disney", material_of(clear_disney())});
  cases.push_back({"clear_disney_inside", material_of(clear_disney()), false});
  cases.push_back({"disney_sheet", material_of(disney_sheet())});
  cases.push_back({"leaf", material_of(DiffuseTransmission{{{0.1f, 0.4f, 0.1f}}, {{0.2f, 0.5f, 0.1f}}})});
  return cases;
}

Frame leaning_frame() {
  return Frame::around(normalize(Vec3{0.3f, -0.2f, 1})).turned_to({0.5f, 1, 0.2f});
}

std::vector<Vec3> viewers() {
  return {{0, 0, 1}, normalize(Vec3{1, 0.3f, 0.8f}), normalize(Vec3{0.2f, -1, 0.15f})};
}

Numbers random_numbers(int i) {
  const auto u = sampling::Sampler(1, i % 1024, i / 1024, 0).pad(0);
  return {{u[0], u[1]}, u[2]};
}

}  // namespace tessera::core::test
