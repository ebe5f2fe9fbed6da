// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/unknown_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

// The keys of glTF 2.0 and of the extensions that are read, in the order of their bytes.
constexpr std::string_view kKnownKeys[] = {"accessors",
                                           "alphaCutoff",
                                           "alphaMode",
                                           "animation",
                                           "animations",
                                           "anisotropyRotation",
                                           "anisotropyStrength",
                                           "anisotropyTexture",
                                           "aspectRatio",
                                           "asset",
                                           "attenuationColor",
                                           "attenuationDistance",
                                           "attributes",
                                           "baseColorFactor",
                                           "baseColorTexture",
                                           "buffer",
                                           "bufferView",
                                           "bufferViews",
                                           "buffers",
                                           "byteLength",
                                           "byteOffset",
                                           "byteStride",
                                           "camera",
                                           "cameras",
                                           "channels",
                                           "children",
                                           "clearcoatFactor",
                                           "clearcoatNormalTexture",
                                           "clearcoatRoughnessFactor",
                                           "clearcoatRoughnessTexture",
                                           "clearcoatTexture",
                                           "coatAnisotropyRotation",
                                           "coatAnisotropyStrength",
                                           "coatAnisotropyTexture",
                                           "coatColorFactor",
                                           "coatColorTexture",
                                           "coatDarkeningFactor",
                                           "coatDarkeningTexture",
                                           "coatFactor",
                                           "coatIor",
                                           "coatNormalTexture",
                                           "coatRoughnessFactor",
                                           "coatRoughnessTexture",
                                           "coatTexture",
                                           "color",
                                           "componentType",
                                           "copyright",
                                           "count",
                                           "diffuseFactor",
                                           "diffuseRoughnessFactor",
                                           "diffuseRoughnessTexture",
                                           "diffuseTexture",
                                           "diffuseTransmissionColorFactor",
                                           "diffuseTransmissionColorTexture",
                                           "diffuseTransmissionFactor",
                                           "diffuseTransmissionTexture",
                                           "dispersion",
                                           "doubleSided",
                                           "emissiveFactor",
                                           "emissiveStrength",
                                           "emissiveTexture",
                                           "extensions",
                                           "extensionsRequired",
                                           "extensionsUsed",
                                           "extras",
                                           "fallback",
                                           "filter",
                                           "fuzzColorFactor",
                                           "fuzzColorTexture",
                                           "fuzzFactor",
                                           "fuzzRoughnessFactor",
                                           "fuzzRoughnessTexture",
                                           "fuzzTexture",
                                           "generator",
                                           "glossinessFactor",
                                           "images",
                                           "index",
                                           "indices",
                                           "innerConeAngle",
                                           "input",
                                           "intensity",
                                           "interpolation",
                                           "inverseBindMatrices",
                                           "ior",
                                           "iridescenceFactor",
                                           "iridescenceIor",
                                           "iridescenceTexture",
                                           "iridescenceThicknessMaximum",
                                           "iridescenceThicknessMinimum",
                                           "iridescenceThicknessTexture",
                                           "joints",
                                           "light",
                                           "lights",
                                           "magFilter",
                                           "mappings",
                                           "material",
                                           "materials",
                                           "matrix",
                                           "max",
                                           "mesh",
                                           "meshes",
                                           "metallicFactor",
                                           "metallicRoughnessTexture",
                                           "mimeType",
                                           "min",
                                           "minFilter",
                                           "minVersion",
                                           "mode",
                                           "name",
                                           "node",
                                           "nodes",
                                           "normalTexture",
                                           "normalized",
                                           "occlusionTexture",
                                           "offset",
                                           "orthographic",
                                           "outerConeAngle",
                                           "output",
                                           "parameters",
                                           "path",
                                           "pbrMetallicRoughness",
                                           "perspective",
                                           "pointer",
                                           "primitives",
                                           "range",
                                           "rotation",
                                           "roughnessFactor",
                                           "sampler",
                                           "samplers",
                                           "scale",
                                           "scene",
                                           "scenes",
                                           "sheenColorFactor",
                                           "sheenColorTexture",
                                           "sheenRoughnessFactor",
                                           "sheenRoughnessTexture",
                                           "shutter",
                                           "skeleton",
                                           "skin",
                                           "skins",
                                           "source",
                                           "sparse",
                                           "specularColorFactor",
                                           "specularColorTexture",
                                           "specularFactor",
                                           "specularGlossinessTexture",
                                           "specularTexture",
                                           "spot",
                                           "strength",
                                           "target",
                                           "targets",
                                           "texCoord",
                                           "textures",
                                           "thicknessFactor",
                                           "thicknessTexture",
                                           "time",
                                           "translation",
                                           "transmissionFactor",
                                           "transmissionTexture",
                                           "type",
                                           "uri",
                                           "values",
                                           "variant",
                                           "variants",
                                           "version",
                                           "visible",
                                           "weights",
                                           "wrapS",
                                           "wrapT",
                                           "xmag",
                                           "yfov",
                                           "ymag",
                                           "zfar",
                                           "znear"};
static_assert(std::is_sorted(std::begin(kKnownKeys), std::end(kKnownKeys)));

// Objects whose keys are names.
constexpr std::string_view kNamedMembers[] = {"attributes", "extras", "targets"};

bool is_one_of(const auto& words, std::string_view word) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

class UnknownKeys {
 public:
  explicit UnknownKeys(const Document& document) : document_(document) {}

  void tell_in(const Value& place, const JsonValue& json) {
    if (const auto* list = json.get_if<JsonValue::Array>()) {
      for (std::size_t i = 0; i < list->size(); ++i)
        if (is_container((*list)[i]))
          tell_in({&(*list)[i], fmt::format("{}[{}]", place.path(), i), &document_}, (*list)[i]);
    } else if (const auto* members = json.get_if<JsonValue::Object>()) {
      for (const JsonValue::Member& member : *members) tell_member(place, member);
    }
  }

 private:
  static bool is_container(const JsonValue& json) {
    return json.get_if<JsonValue::Array>() != nullptr || json.get_if<JsonValue::Object>() != nullptr;
  }
  Value child_of(const Value& place, const JsonValue::Member& member) const {
    const std::string dot = place.path().empty() ? "" : ".";
    return {&member.value, place.path() + dot + member.key, &document_};
  }

  void tell_member(const Value& place, const JsonValue::Member& member) {
    if (!std::binary_search(std::begin(kKnownKeys), std::end(kKnownKeys), member.key)) {
      tell_unknown(child_of(place, member), member.key);
    } else if (member.key == "extensions") {
      tell_in_extensions(child_of(place, member), member.value);
    } else if (is_container(member.value) && !is_one_of(kNamedMembers, member.key)) {
      tell_in(child_of(place, member), member.value);
    }
  }

  // The search for similar keys takes longer than all else, and many places may have the same key.
  void tell_unknown(const Value& place, const std::string& key) {
    auto [similar, is_new] = similar_.try_emplace(key);
    if (is_new) similar->second = suggestion(key, {std::begin(kKnownKeys), std::end(kKnownKeys)});
    document_.warn(place, "unknown key " + key, "this key is not known, and ignored" + similar->second);
  }

  // check_extensions() tells those that the file lists.
  void tell_in_extensions(const Value& place, const JsonValue& json) {
    const auto* members = json.get_if<JsonValue::Object>();
    for (std::size_t i = 0; members != nullptr && i < members->size(); ++i) {
      const auto& [name, line, value] = (*members)[i];
      const Value extension = child_of(place, (*members)[i]);
      if (Document::knows_extension(name))
        tell_in(extension, value);
      else if (!Document::is_invisible_extension(name) && !listed_.contains(name))
        document_.tell_unsupported_extension(extension, name);
    }
  }

  const Document& document_;
  const std::set<std::string> listed_ = document_.listed_extensions();
  std::map<std::string, std::string> similar_;  // of each unknown key
};

}  // namespace

void tell_unknown_keys(const Document& document, const JsonValue& json) {
  UnknownKeys(document).tell_in(document.root(), json);
}

}  // namespace tessera::core::gltf
