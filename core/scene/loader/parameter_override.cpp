// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/parameter_override.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/scene/gltf/binary_container.hpp"
#include "core/scene/import/scene_format.hpp"
#include "core/scene/import/selection.hpp"
#include "core/scene/loader/json_splice.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/loader/xml_default.hpp"

namespace tessera::core {
namespace {

tl::unexpected<Error> invalid_override(const std::string& path, const std::string& what) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("{}: {}", path, what));
}

bool is_json(std::string_view text, bool with_comments) {
  return nlohmann::json::accept(text.begin(), text.end(), with_comments);
}

bool is_word(std::string_view text) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == '/' || c == '+';
  };
  return !text.empty() && std::all_of(text.begin(), text.end(), is_letter);
}

bool can_be_selected(const ParameterOverride& wanted, SceneFormat format) {
  return format == SceneFormat::kGltf || (format == SceneFormat::kMitsuba && wanted.path == kSelectCamera);
}

bool has_parameters(SceneFormat format) {
  return format == SceneFormat::kTessera || format == SceneFormat::kMitsuba || format == SceneFormat::kGltf;
}

// INVALID_ARGUMENT if scenes of the format have nothing of this kind.
Status check_format(const std::string& path, const ParameterOverride& wanted, SceneFormat format) {
  if (wanted.kind == ParameterOverride::Kind::kParameter && !has_parameters(format))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} has no parameters that -D can replace; those of .json, .gltf, .glb and "
                            "Mitsuba's .xml files can be",
                            in_quotes(path)));
  if (wanted.kind == ParameterOverride::Kind::kSelection && !can_be_selected(wanted, format))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} has nothing that --{}{} can choose; {}", in_quotes(path),
                    wanted.path == kSelectTime || wanted.path == kSelectShutter ? "animation-" : "",
                    wanted.path,
                    wanted.path == kSelectCamera ? "glTF and Mitsuba files have" : "glTF files have"));
  return {};
}

Result<std::string> with_xml_override(std::string xml, const ParameterOverride& wanted) {
  if (wanted.kind == ParameterOverride::Kind::kSelection)
    return with_xml_default(std::move(xml), std::string(kMitsubaSelection) + wanted.path, wanted.value);
  if (!is_word(wanted.path) || wanted.path.find('.') != std::string::npos)
    return invalid_override(wanted.path, "a Mitsuba scene has parameters with plain names, as -D spp=64");
  return with_xml_default(std::move(xml), wanted.path, wanted.value);
}

// The JSON of a parameter's value.
Result<std::string> json_value(const ParameterOverride& wanted) {
  // A comment would hide what comes behind the value in the scene file.
  if (is_json(wanted.value, false)) return wanted.value;
  if (is_word(wanted.value)) return json_string(wanted.value);
  return invalid_override(
      wanted.path,
      fmt::format("the value must be written as in a scene file: a number, [x, y, z], \"a text\"; got {}",
                  in_quotes(wanted.value)));
}

Result<std::string> with_json_override(std::string text, const ParameterOverride& wanted) {
  if (wanted.kind == ParameterOverride::Kind::kParameter) {
    const auto value = json_value(wanted);
    return value ? with_json_value(std::move(text), wanted.path, *value) : value;
  }
  return with_json_value(std::move(text), fmt::format("extensions.{}.{}", kGltfSelection, wanted.path),
                         wanted.value);
}

// Lets the reader check that the scene uses what is replaced; our own format knows all of its keys.
std::vector<ParameterOverride> with_names(std::vector<ParameterOverride> overrides, SceneFormat format) {
  if (format == SceneFormat::kTessera) return overrides;
  std::string names;
  for (const ParameterOverride& each : overrides)
    if (each.kind == ParameterOverride::Kind::kParameter) names += (names.empty() ? "" : "\n") + each.path;
  if (!names.empty()) overrides.push_back(select_by_name(kReplacedParameters, names));
  return overrides;
}

Result<std::string> with_glb_overrides(const std::string& bytes,
                                       std::span<const ParameterOverride> overrides) {
  const auto parts = gltf::split_binary(bytes);
  if (!parts) return bytes;  // the reader says why
  auto text = with_overrides(std::string(parts->json), overrides);
  if (!text) return text;
  return gltf::join_binary(*text, parts->binary);
}

}  // namespace

Result<ParameterOverride> parse_override(std::string_view text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  ParameterOverride parsed;
  parsed.path = text.substr(0, equals);
  if (equals == text.size() || !is_value_path(parsed.path))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("must be PATH=VALUE such as camera.position=[0,1,5]; got '{}'", text));
  parsed.value = text.substr(equals + 1);
  std::replace(parsed.value.begin(), parsed.value.end(), '\n', ' ');
  return parsed;
}

ParameterOverride select_by_name(std::string_view what, const std::string& name) {
  return {std::string(what), json_string(name), ParameterOverride::Kind::kSelection};
}

ParameterOverride select_time(double seconds) {
  return {std::string(kSelectTime), fmt::format("{}", seconds), ParameterOverride::Kind::kSelection};
}

ParameterOverride select_shutter(double seconds) {
  return {std::string(kSelectShutter), fmt::format("{}", seconds), ParameterOverride::Kind::kSelection};
}

Result<std::string> with_overrides(std::string text, std::span<const ParameterOverride> overrides) {
  const bool as_xml = is_xml(text);
  if (!as_xml && !is_json(text, true)) return text;
  Result<std::string> changed = std::move(text);
  for (const ParameterOverride& wanted : overrides) {
    changed = as_xml ? with_xml_override(*std::move(changed), wanted)
                     : with_json_override(*std::move(changed), wanted);
    if (!changed) return changed;
  }
  return changed;
}

Result<std::string> OverriddenAssets::read(const std::string& path) {
  auto bytes = inner_.read(path);
  if (!bytes || path != scene_path_ || overrides_.empty()) return bytes;
  const auto format = format_of(path, *bytes);
  if (!format) return fail(format.error());
  for (const ParameterOverride& wanted : overrides_)
    if (const Status fits = check_format(path, wanted, *format); !fits) return fail(fits.error());
  const std::vector<ParameterOverride> all = with_names(overrides_, *format);
  if (gltf::is_binary(*bytes)) return with_glb_overrides(*bytes, all);
  return with_overrides(std::move(*bytes), all);
}

}  // namespace tessera::core
