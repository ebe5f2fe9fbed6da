// SPDX-License-Identifier: Apache-2.0
// Recognises the format of a scene file. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/scene/loader/asset_source.hpp"

namespace tessera::core {

enum class SceneFormat { kTessera, kGltf, kPbrt, kMitsuba, kObj, kPly, kStl };

// "glTF", "Mitsuba"
std::string_view scene_format_name(SceneFormat format);

// By the ending of the file's name, ignoring case: .json, .gltf, .glb, .pbrt, .xml, .obj, .ply, .ply.gz or
// .stl. nullopt for any other.
std::optional<SceneFormat> format_by_ending(std::string_view path);
// By the first bytes of the file. kTessera if nothing else fits: its reader says what is wrong.
SceneFormat format_by_content(std::string_view bytes);
// By the ending or else by the first bytes. Errors are those of reading the file.
Result<SceneFormat> format_of(AssetSource& assets, const std::string& path);

}  // namespace tessera::core
