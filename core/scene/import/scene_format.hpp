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

// By the ending of the file's name, ignoring case: .json, .gltf, .glb, .pbrt, .pbrt.gz, .xml, .obj, .ply,
// .ply.gz or .stl. nullopt for any other.
std::optional<SceneFormat> format_by_ending(std::string_view path);
// By the bytes of the file. nullopt if no format fits.
std::optional<SceneFormat> format_by_content(std::string_view bytes);
// By the ending or else by the bytes. XML named .pbrt is Mitsuba's, and pbrt's text named .xml is pbrt's. The
// error of a file that has neither a known ending nor a known content lists the formats.
Result<SceneFormat> format_of(const std::string& path, std::string_view bytes);
// Reads the file if the ending does not decide. Errors are also those of reading.
Result<SceneFormat> format_of(AssetSource& assets, const std::string& path);

}  // namespace tessera::core
