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
      {"rough_glass_unreflecting", rough_glass(1.5f, 0.6f, DielectricFresnel::kNone)}};
  std::vector<BsdfCase> cases;
  for (const auto& [name, model] : models) {
    cases.push_back({name, material_of(model)});
    cases.push_back({name + "_uniform", material_of(model, Sampling::kUniform)});
    if (std::holds_alternative<CookTorrance>(model))
      cases.push_back({name + "_half_vector", material_of(model, Sampling::kHalfVector)});
    if (std::holds_alternative<Glass>(model)) cases.push_back({name + "_inside", material_of(model), false});
  }
  return cases;
}

std::vector<Vec3> viewers() {
  return {{0, 0, 1}, normalize(Vec3{1, 0.3f, 0.8f}), normalize(Vec3{0.2f, -1, 0.15f})};
}

Numbers random_numbers(int i) {
  const auto u = Sampler(1, i % 1024, i / 1024, 0).pad(0);
  return {{u[0], u[1]}, u[2]};
}

}  // namespace tessera::core::test
