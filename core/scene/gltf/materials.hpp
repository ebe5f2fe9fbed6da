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

namespace tessera::core::gltf {

// Whether its alphaMode is not OPAQUE.
bool is_transparent(const Value& material);
// Whether it has KHR_materials_unlit.
bool is_unlit(const Value& material);

class Materials {
 public:
  Materials(const Document& document, Textures& textures) : document_(document), textures_(textures) {}

  struct Use {
    std::uint32_t material = 0;      // of the scene
    std::uint32_t uv_set = 0;        // the texture coordinates of its textures
    std::vector<Value> other_uvs{};  // textureInfos with another set
  };
  // The material of an index in the file, or the default one if it is absent; each is converted once.
  Use use(const Value& index);

 private:
  Use convert(const Value& material);
  static void find_uv_sets(const Value& material, Use& use);
  Material surface(const Value& material);
  Principled principled(const Value& material);
  std::uint32_t with_diffuse_transmission(const Value& material, const Value& extension);
  void add_metallic_roughness(const Value& place, Principled& model);
  void add_specular_glossiness(const Value& extension, Principled& model);
  void add_specular(const Value& extension, Principled& model);
  void add_transmission(const Value& material, Principled& model);
  void add_anisotropy(const Value& extension, Principled& model);
  void add_coat(const Value& extension, Principled& model);
  void add_sheen(const Value& extension, Principled& model);
  void add_iridescence(const Value& extension, Principled& model);
  Material unlit(const Value& material);
  ScalarParameter opacity(const Value& material);
  ColorParameter base_color(const Value& material);
  void add_emission(const Value& material, Material& surface);
  std::uint32_t add(const Value& material, Material surface);

  // A number or colour from 0 to 1, clamped with a warning, times a texture.
  ScalarParameter share(const Value& place, std::string_view key, float otherwise, int texture = -1) const;
  // `value`, which the key gives, within limits; told if it was outside.
  float within(const Value& place, std::string_view key, float value, float least, float most) const;
  Rgb clamped(const Value& place, Rgb color) const;
  ColorParameter tint(const Value& place, std::string_view key, Rgb otherwise, int texture = -1) const;

  const Document& document_;
  Textures& textures_;
  std::map<std::string, Use> converted_;  // by path
};

}  // namespace tessera::core::gltf
