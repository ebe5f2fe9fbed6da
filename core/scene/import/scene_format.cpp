// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_format.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "core/base/letter_case.hpp"

namespace tessera::core {
namespace {

constexpr std::array<std::pair<std::string_view, SceneFormat>, 9> kEndings{{
    {".json", SceneFormat::kTessera},
    {".gltf", SceneFormat::kGltf},
    {".glb", SceneFormat::kGltf},
    {".pbrt", SceneFormat::kPbrt},
    {".xml", SceneFormat::kMitsuba},
    {".obj", SceneFormat::kObj},
    {".ply", SceneFormat::kPly},
    {".ply.gz", SceneFormat::kPly},
    {".stl", SceneFormat::kStl},
}};

std::string_view without_leading_blanks(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

bool contains_word(std::string_view text, std::string_view word) {
  return text.find(word) != std::string_view::npos;
}

}  // namespace

std::string_view scene_format_name(SceneFormat format) {
  switch (format) {
    case SceneFormat::kTessera:
      return "Tessera";
    case SceneFormat::kGltf:
      return "glTF";
    case SceneFormat::kPbrt:
      return "pbrt";
    case SceneFormat::kMitsuba:
      return "Mitsuba";
    case SceneFormat::kObj:
      return "OBJ";
    case SceneFormat::kPly:
      return "PLY";
    case SceneFormat::kStl:
      return "STL";
  }
  return "";
}

std::optional<SceneFormat> format_by_ending(std::string_view path) {
  for (const auto& [ending, format] : kEndings)
    if (ends_with_ignoring_case(path, ending)) return format;
  return std::nullopt;
}

SceneFormat format_by_content(std::string_view bytes) {
  constexpr std::size_t kHead = 4096;
  if (bytes.starts_with("glTF")) return SceneFormat::kGltf;
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return SceneFormat::kPly;
  const std::string_view head = without_leading_blanks(bytes.substr(0, kHead));
  if (head.starts_with("solid") && contains_word(head, "facet")) return SceneFormat::kStl;
  if (head.starts_with("<") && contains_word(head, "<scene")) return SceneFormat::kMitsuba;
  if (head.starts_with("{"))
    return contains_word(head, "\"asset\"") && contains_word(head, "\"version\"") ? SceneFormat::kGltf
                                                                                  : SceneFormat::kTessera;
  if (contains_word(head, "WorldBegin") || contains_word(head, "LookAt ")) return SceneFormat::kPbrt;
  return SceneFormat::kTessera;
}

Result<SceneFormat> format_of(AssetSource& assets, const std::string& path) {
  if (const auto format = format_by_ending(path)) return *format;
  const auto bytes = assets.read(path);
  if (!bytes) return fail(bytes.error());
  return format_by_content(*bytes);
}

}  // namespace tessera::core
