// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/scene/gltf/binary_container.hpp"
#include "core/scene/gltf/unknown_keys.hpp"
#include "core/scene/import/selection.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

constexpr std::array<std::string_view, 27> kKnownExtensions{
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_coat",               // a draft
    "KHR_materials_diffuse_roughness",  // a draft
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_fuzz",  // a draft
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
};

// Data about the file and its parts, and what happens while one plays with it.
constexpr std::array<std::string_view, 17> kInvisibleExtensions{
    "EXT_instance_features", "EXT_mesh_features",      "EXT_structural_metadata",  "FB_ngon_encoding",
    "GODOT_single_root",     "KHR_audio_emitter",      "KHR_implicit_shapes",      "KHR_interactivity",
    "KHR_node_hoverability", "KHR_node_selectability", "KHR_physics_rigid_bodies", "KHR_xmp",
    "KHR_xmp_json_ld",       "MSFT_audio_emitter",     "OMI_audio_emitter",        "OMI_physics_body",
    "OMI_physics_shape",
};

// Images of formats that cannot be read: the textures have a fallback, or are ignored.
constexpr std::array<std::string_view, 3> kUnreadableImages{"EXT_texture_avif", "KHR_texture_basisu",
                                                            "MSFT_texture_dds"};

bool is_among(const auto& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_known_extension(std::string_view name) {
  return is_among(kKnownExtensions, name);
}

[[noreturn]] void refuse_file(std::string what) {
  throw Refusal{0, {ErrorCode::kInvalidArgument, std::move(what)}, false};
}

// The text of an element of a list of texts.
std::string text_of(const JsonValue* list, std::size_t i) {
  const auto* text = (*list->get_if<JsonValue::Array>())[i].get_if<std::string>();
  return text == nullptr ? std::string() : *text;
}

}  // namespace

Document::Document(std::string bytes, SceneBuilder& builder) : builder_(builder), bytes_(std::move(bytes)) {
  const std::string_view text = split();
  const std::string shown = builder.shown(builder.scene_path());
  Mistakes repeated_keys(shown);
  auto json = parse_json(text, shown, repeated_keys);
  if (!json) throw Refusal{0, json.error(), true};
  json_ = std::move(*json);
  if (!repeated_keys.empty())
    warn(root(), "repeated keys", "has keys twice in an object; the first of each is used");
  check_version();
  check_extensions();
  tell_unknown_keys(*this, json_);
}

bool Document::knows_extension(std::string_view name) {
  return is_known_extension(name) || name == kGltfSelection;
}

bool Document::is_invisible_extension(std::string_view name) {
  return is_among(kInvisibleExtensions, name);
}

std::set<std::string> Document::listed_extensions() const {
  std::set<std::string> listed;
  for (const auto& [key, line, list] : *json_.get_if<JsonValue::Object>()) {
    if (key != "extensionsRequired" && key != "extensionsUsed") continue;
    const auto* names = list.get_if<JsonValue::Array>();
    for (std::size_t i = 0; names != nullptr && i < names->size(); ++i) listed.insert(text_of(&list, i));
  }
  return listed;
}

void Document::tell_unsupported_extension(const Value& place, std::string_view name) const {
  warn(place, name,
       fmt::format("the optional extension {} is not supported; it is ignored", in_quotes(name)));
}

void Document::tell_unreadable_images(const Value& place, std::string_view name) const {
  warn(
      place, name,
      fmt::format("the images of {} cannot be read; textures that have no other are ignored: convert them to "
                  "PNG or JPEG",
                  in_quotes(name)));
}

std::string_view Document::split() {
  if (!gltf::is_binary(bytes_)) return bytes_;
  is_binary_ = true;
  const auto parts = split_binary(bytes_);
  if (!parts) refuse_file(parts.error().message);
  binary_ = parts->binary;
  return parts->json;
}

void Document::check_version() const {
  if (root().keys().empty()) refuse_file("is not glTF: its JSON is no object with keys");
  const Value asset = root()["asset"];
  const std::string version = asset.text("version");
  if (version.empty()) return warn(root(), "version", "says no version of glTF; it is read as glTF 2.0");
  const std::string needed = asset.text("minVersion");
  if (version == "2") warn(asset, "version", "has the version 2; it is read as glTF 2.0");
  if (!(version + ".").starts_with("2.") || (!needed.empty() && needed != "2.0"))
    asset.refuse(fmt::format("is glTF {}; only 2.0 can be read", needed.empty() ? version : needed));
}

void Document::check_extensions() const {
  const auto* object = json_.get_if<JsonValue::Object>();
  std::set<std::string> told;
  for (const auto& [key, line, list] : *object) {
    if ((key != "extensionsRequired" && key != "extensionsUsed") || !list.get_if<JsonValue::Array>())
      continue;
    for (std::size_t i = 0; i < list.get_if<JsonValue::Array>()->size(); ++i) {
      const std::string name = text_of(&list, i);
      if (is_known_extension(name) || is_invisible_extension(name)) continue;
      if (is_among(kUnreadableImages, name)) {
        if (told.insert(name).second) tell_unreadable_images(Value(&list, key, this), name);
        continue;
      }
      if (key == "extensionsRequired")
        Value(&list, key, this)
            .refuse(fmt::format("needs the extension {}, which is not supported", in_quotes(name)));
      tell_unsupported_extension(Value(&list, key, this), name);
    }
  }
}

Value Document::element(const Value& list, const Value& index) {
  const std::uint64_t i = index.whole();
  if (i >= list.size())
    index.refuse(fmt::format("there is no {}[{}]; the file has {}", list.path(), i, list.size()));
  return list.at(static_cast<std::size_t>(i));
}

Value Document::element_or_none(const Value& list, const Value& index, std::string_view instead) const {
  Value found;
  try_to(index, list.path(), instead, [&] { found = element(list, index); });
  return found;
}

void Document::tell_refusal(const Refusal& refusal, const Value& place, std::string_view kind,
                            std::string_view instead) const {
  const ErrorCode code = refusal.error.code;
  if (code != ErrorCode::kInvalidArgument && code != ErrorCode::kNotFound) throw;
  std::string_view why = refusal.error.message;
  const std::string own_place = place.path() + ": ";
  if (why.starts_with(own_place)) why.remove_prefix(own_place.size());
  warn(place, kind, fmt::format("{}: {}", instead, why));
}

void Document::warn(const Value& place, std::string_view kind, std::string_view text) const {
  builder_.warn(builder_.scene_path(), line_of(place), kind, [&] {
    return printable(place.path().empty() ? std::string(text) : fmt::format("{}: {}", place.path(), text));
  });
}

}  // namespace tessera::core::gltf
