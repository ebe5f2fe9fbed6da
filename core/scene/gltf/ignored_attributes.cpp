// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/ignored_attributes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

constexpr std::string_view kColors = "COLOR_", kCoordinates = "TEXCOORD_";

// Objects of a material that name a texture.
std::vector<Value> textures_of(const Value& material) {
  std::vector<Value> places{material["pbrMetallicRoughness"], material}, infos;
  for (const std::string& name : material["extensions"].keys()) places.push_back(material.extension(name));
  for (const Value& place : places)
    for (const std::string& key : place.keys())
      if (key.ends_with("Texture")) infos.push_back(place[key]);
  return infos;
}

// Why the attribute is ignored; empty if it is not, or if nobody misses it.
std::string why_ignored(std::string_view name, const Value& attributes, const Value& material,
                        const std::vector<std::string>& used) {
  for (const std::string_view read : {"POSITION", "NORMAL", "COLOR_0"})
    if (name == read) return {};
  for (const std::string_view told : {"_", "JOINTS_", "WEIGHTS_"})
    if (name.starts_with(told)) return {};
  if (name == "TANGENT") {
    if (attributes["NORMAL"].exists() || !follows_tangents(material)) return {};
    return "the tangents of a mesh without normals are ignored, as glTF demands";
  }
  if (name.starts_with(kCoordinates)) {
    if (std::find(used.begin(), used.end(), name) != used.end()) return {};
    return fmt::format("{} is ignored: no texture of its material uses it", name);
  }
  if (name.starts_with(kColors)) return fmt::format("{} is ignored: only COLOR_0 is used", name);
  return fmt::format("there is no attribute {}; it is ignored", in_quotes(name));
}

}  // namespace

bool follows_tangents(const Value& material) {
  return material["normalTexture"].exists() || material.extension("KHR_materials_anisotropy").exists() ||
         material.extension("KHR_materials_clearcoat")["clearcoatNormalTexture"].exists() ||
         material.extension("KHR_materials_coat").exists();
}

std::vector<std::string> coordinate_names(const Value& material) {
  std::vector<std::string> names;
  for (const Value& info : textures_of(material)) {
    const Value transformed = info.extension("KHR_texture_transform")["texCoord"];
    const auto named = (transformed.exists() ? transformed : info["texCoord"]).as_whole();
    names.push_back(fmt::format("{}{}", kCoordinates, named.value_or(0)));
  }
  if (names.empty()) names.push_back(fmt::format("{}0", kCoordinates));
  return names;
}

void tell_ignored_attributes(const Document& document, const Value& primitive, const Value& material,
                             const std::vector<std::string>& used) {
  const Value attributes = primitive["attributes"];
  for (const std::string& name : attributes.keys())
    if (const std::string why = why_ignored(name, attributes, material, used); !why.empty())
      document.warn(attributes[name], "ignored " + name, why);
}

}  // namespace tessera::core::gltf
