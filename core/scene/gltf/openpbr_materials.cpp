// SPDX-License-Identifier: Apache-2.0
// The drafts of extensions that name parameters of OpenPBR: KHR_materials_diffuse_roughness, _coat and _fuzz.
#include "core/scene/gltf/materials.hpp"

namespace tessera::core::gltf {

void Materials::add_diffuse_roughness(const Value& extension, Principled& model) {
  if (!extension.exists()) return;
  model.base_diffuse_roughness =
      share(extension, "diffuseRoughnessFactor", 0,
            textures_.data(extension["diffuseRoughnessTexture"], TextureChannel::kRed));
}

// KHR_materials_clearcoat with the rest of OpenPBR's coat.
void Materials::add_openpbr_coat(const Value& material, Principled& model) {
  const Value extension = material.extension("KHR_materials_coat");
  if (!(extension.number_or("coatFactor", 0) > 0)) return;
  const Factor weight = factor(extension, "coatFactor", 0, "coatTexture", TextureChannel::kRed);
  model.coat_weight = parameter(weight);
  model.coat_ior = within(extension, "coatIor", extension.number_or("coatIor", 1.5f), 1, kMaxIor);
  model.coat_color =
      tint(extension, "coatColorFactor", Rgb::gray(1), textures_.color(extension["coatColorTexture"]));
  model.coat_darkening = share(extension, "coatDarkeningFactor", 1);
  LayerRoughness coat;
  coat.roughness =
      factor(extension, "coatRoughnessFactor", 0, "coatRoughnessTexture", TextureChannel::kGreen);
  coat.strength.value =
      within(extension, "coatAnisotropyStrength", extension.number_or("coatAnisotropyStrength", 0), 0, 1);
  const Roughness made = roughness_of(extension, coat);
  model.coat_roughness = made.roughness;
  model.coat_roughness_anisotropy = made.anisotropy;
  keep_index_below_coat(extension, weight, model);
  for (const char* key : {"coatDarkeningTexture", "coatAnisotropyTexture"})
    if (extension[key].exists()) document_.warn(extension[key], key, "is not supported; it is ignored");
  model.coat_tangent.rotation = turns_of(extension.number_or("coatAnisotropyRotation", 0));
  set_coat_normal(material, extension["coatNormalTexture"], model);
}

void Materials::add_fuzz(const Value& extension, Principled& model) {
  if (!(extension.number_or("fuzzFactor", 0) > 0)) return;
  model.fuzz_weight =
      share(extension, "fuzzFactor", 0, textures_.data(extension["fuzzTexture"], TextureChannel::kRed));
  model.fuzz_color =
      tint(extension, "fuzzColorFactor", Rgb::gray(1), textures_.color(extension["fuzzColorTexture"]));
  model.fuzz_roughness = share(extension, "fuzzRoughnessFactor", 0.5f,
                               textures_.data(extension["fuzzRoughnessTexture"], TextureChannel::kAlpha));
}

}  // namespace tessera::core::gltf
