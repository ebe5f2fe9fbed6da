// SPDX-License-Identifier: Apache-2.0
// Materials of a glTF file as the scene's, in terms of OpenPBR (Principled). docs/importing.md lists what is
// approximated. Not thread-safe; functions throw Refusals.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/materials/material.hpp"
#include "core/scene/gltf/document.hpp"
#include "core/scene/gltf/textures.hpp"
#include "core/scene/gltf/vertex_tints.hpp"

namespace tessera::core::gltf {

class Materials {
 public:
  Materials(const Document& document, Textures& textures) : document_(document), textures_(textures) {}

  struct Use {
    std::uint32_t material = 0;  // of the scene
    Value value{};               // of the file; absent for the default one
    Textures::Coordinates coordinates{};
    std::vector<std::string> coordinate_names{};  // of the attributes that its textures use
    bool transparent = false;                     // its alphaMode is not OPAQUE
    bool unlit = false;                           // it has KHR_materials_unlit
    bool transmits = false;                       // clearly, with the base colour
  };
  // The material of an index in the file, or the default one if it is absent or, after a warning, there is no
  // such material; each is converted once.
  Use use(const Value& index);
  // The same material, whose alpha and colours of emission, if unlit, and transmission are multiplied.
  std::uint32_t tinted(const Use& use, const VertexTint& tint);

 private:
  // A number of the file, times a channel of a texture.
  struct Factor {
    float value = 0;
    Value info{};  // absent: no texture
    TextureChannel channel = TextureChannel::kColor;

    Textures::Input input() const { return {value > 0 ? info : Value(), {ColorSpace::kLinear, channel}}; }
  };
  // What the roughness of a layer depends on, in terms of glTF.
  struct LayerRoughness {
    Factor roughness;
    bool is_glossiness = false;  // 1 - roughness
    Factor strength{};           // of anisotropy
    // OpenPBR's coat above blurs the layer, which glTF's does not.
    Factor coat_weight{}, coat_roughness{};

    bool is_blurred() const { return coat_weight.value > 0 && coat_roughness.value > 0; }
    std::string name() const;  // differs where the same textures give another roughness
  };
  // In terms of OpenPBR.
  struct Roughness {
    ScalarParameter roughness, anisotropy = 0;
  };
  // Of an angle in radians, in [-1/2, 1/2].
  static float turns_of(float radians);

  Use convert(const Value& material);
  Material surface(const Value& material);
  Principled principled(const Value& material);
  void add_diffuse_transmission(const Value& material, Principled& model);
  void add_metalness(const Value& place, Principled& model);
  void add_specular_glossiness(const Value& extension, Principled& model);
  void add_specular(const Value& extension, Principled& model);
  Rgb specular_color(const Value& extension, Principled& model);
  void add_transmission(const Value& material, Principled& model);
  void add_anisotropy_direction(const Value& extension, Principled& model);
  void add_roughness(const Value& material, Principled& model);
  Roughness roughness_of(const Value& place, const LayerRoughness& layer);
  void keep_index_below_coat(const Value& extension, const Factor& coat_weight, Principled& model);
  void add_coat(const Value& material, Principled& model);
  Factor clearcoat_weight(const Value& extension) const;
  Factor clearcoat_roughness(const Value& extension) const;
  void set_coat_normal(const Value& material, const Value& info, Principled& model);
  void add_diffuse_roughness(const Value& extension, Principled& model);
  void add_clearcoat(const Value& material, Principled& model);
  void add_openpbr_coat(const Value& material, Principled& model);
  void add_fuzz(const Value& extension, Principled& model);
  void add_sheen(const Value& extension, Principled& model);
  void add_iridescence(const Value& extension, Principled& model);
  NormalMap normal_map(const Value& info);
  // The index of a new medium, or kNoMedium.
  int medium_inside(const Value& material, const Principled& model);
  Material unlit(const Value& material);
  // `vertex_alpha` multiplies alpha.
  ScalarParameter opacity(const Value& material, float vertex_alpha = 1);
  ColorParameter base_color(const Value& material);
  void add_emission(const Value& material, Material& surface);
  std::uint32_t add(const Value& material, Material surface);

  // A number from 0 to 1, clamped with a warning, with the texture of `texture_key`.
  Factor factor(const Value& place, std::string_view key, float otherwise, std::string_view texture_key,
                TextureChannel channel) const;
  ScalarParameter parameter(const Factor& factor);
  // A number or colour from 0 to 1, clamped with a warning, times a texture.
  ScalarParameter share(const Value& place, std::string_view key, float otherwise, int texture = -1) const;
  // `value`, which the key gives, within limits; told if it was outside.
  float within(const Value& place, std::string_view key, float value, float least, float most) const;
  Rgb clamped(const Value& place, Rgb color) const;
  ColorParameter tint(const Value& place, std::string_view key, Rgb otherwise, int texture = -1) const;

  const Document& document_;
  Textures& textures_;
  std::map<std::string, Use> converted_;         // by path
  std::map<std::string, std::uint32_t> tinted_;  // by path and tint
};

}  // namespace tessera::core::gltf
