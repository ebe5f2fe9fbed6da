// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_format.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "core/base/letter_case.hpp"
#include "core/scene/loader/gunzip.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/loader/text_lines.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kHead = 4096;

constexpr std::array<std::pair<std::string_view, SceneFormat>, 10> kEndings{{
    {".json", SceneFormat::kTessera},
    {".gltf", SceneFormat::kGltf},
    {".glb", SceneFormat::kGltf},
    {".pbrt", SceneFormat::kPbrt},
    {".pbrt.gz", SceneFormat::kPbrt},
    {".xml", SceneFormat::kMitsuba},
    {".obj", SceneFormat::kObj},
    {".ply", SceneFormat::kPly},
    {".ply.gz", SceneFormat::kPly},
    {".stl", SceneFormat::kStl},
}};

std::string_view without_leading_blanks(std::string_view text) {
  text = without_byte_order_mark(text);
  return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

bool contains_word(std::string_view text, std::string_view word) {
  return text.find(word) != std::string_view::npos;
}

// Whether the complete lines of the head are statements of OBJ files, and a vertex is among them.
bool is_obj(std::string_view bytes) {
  constexpr std::array<std::string_view, 12> kStatements{"v", "vn", "vt", "vp", "f",      "l",
                                                         "p", "o",  "g",  "s",  "mtllib", "usemtl"};
  std::string_view head = bytes.substr(0, kHead);
  if (head.size() < bytes.size()) head = head.substr(0, head.find_last_of("\r\n"));
  bool has_vertex = false;
  for (StatementLines lines(head); lines.next();) {
    std::string_view line = without_comment(lines.line());
    const std::string_view keyword = take_word(line);
    if (keyword.empty()) continue;
    if (std::ranges::find(kStatements, keyword) == kStatements.end()) return false;
    std::array<float, 3> position{};
    if (keyword == "v") has_vertex = has_vertex || read_numbers(line, position).count >= 3;
  }
  return has_vertex;
}

// Only readers of PLY and pbrt files decompress them.
std::optional<SceneFormat> format_of_gzip(std::string_view bytes) {
  std::string content;
  const auto plain = gunzipped(bytes, content);
  if (!plain || is_gzip(*plain)) return std::nullopt;
  const auto format = format_by_content(*plain);
  return format == SceneFormat::kPly || format == SceneFormat::kPbrt ? format : std::nullopt;
}

// Files of these formats are often named as the other; neither can be read as the other.
bool may_be_misnamed(SceneFormat format) {
  return format == SceneFormat::kPbrt || format == SceneFormat::kMitsuba;
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

std::optional<SceneFormat> format_by_content(std::string_view bytes) {
  if (is_gzip(bytes)) return format_of_gzip(bytes);
  if (bytes.starts_with("glTF")) return SceneFormat::kGltf;
  const std::string_view head = without_leading_blanks(bytes.substr(0, kHead));
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return SceneFormat::kPly;
  if (head.starts_with("<"))
    return contains_word(head, "<scene") && !contains_word(head, "<COLLADA")
               ? std::optional(SceneFormat::kMitsuba)
               : std::nullopt;
  if (head.starts_with("{"))
    return contains_word(head, "\"asset\"") && contains_word(head, "\"version\"") ? SceneFormat::kGltf
                                                                                  : SceneFormat::kTessera;
  if (is_stl(bytes)) return SceneFormat::kStl;
  if (is_obj(without_leading_blanks(bytes))) return SceneFormat::kObj;
  if (contains_word(head, "WorldBegin") || contains_word(head, "LookAt ")) return SceneFormat::kPbrt;
  return std::nullopt;
}

Result<SceneFormat> format_of(const std::string& path, std::string_view bytes) {
  const auto named = format_by_ending(path);
  if (named && !may_be_misnamed(*named)) return *named;
  const auto found = format_by_content(bytes);
  if (named) return found && may_be_misnamed(*found) ? *found : *named;
  if (found) return *found;
  return fail(
      ErrorCode::kInvalidArgument,
      "the format is not known; those that can be read are .json, .gltf, .glb, .pbrt, .xml (Mitsuba), "
      ".obj, .ply and .stl");
}

Result<SceneFormat> format_of(AssetSource& assets, const std::string& path) {
  const auto named = format_by_ending(path);
  if (named && !may_be_misnamed(*named)) return *named;
  const auto bytes = assets.read(path);
  if (!bytes) return fail(bytes.error());
  return format_of(path, *bytes);
}

}  // namespace tessera::core
