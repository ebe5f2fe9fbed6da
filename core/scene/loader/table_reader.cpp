// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/table_reader.hpp"

#include <fmt/format.h>

#include <array>

#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

constexpr std::array kTexturedColorKeys{KeyRule{"texture", scene_keys::kRequired}, KeyRule{"tint"}};
constexpr std::array kTexturedNumberKeys{KeyRule{"texture", scene_keys::kRequired}, KeyRule{"scale"}};
constexpr ObjectRules kTexturedColor{"textured colour", {}, kTexturedColorKeys};
constexpr ObjectRules kTexturedNumber{"textured number", {}, kTexturedNumberKeys};

int read_whole(const Field& field, const Range& range) {
  const auto* number = field.value().get_if<JsonValue::Number>();
  if (number != nullptr && number->whole && range.contains(number->value))
    return static_cast<int>(*number->whole);
  field.must_be(phrase_of(range));
  return 0;
}

bool is_text(const Field& field) {
  return field.value().get_if<std::string>() != nullptr;
}

// The value is written without a texture.
bool is_constant(const Field& field) {
  return !field.value().get_if<JsonValue::Object>() || has_keyframes(field);
}

}  // namespace

int read_index(const Field& field, const Domain& domain, const KnownNames& names) {
  if (domain.names == NamesOf::kTextures) return read_texture_name(field, *names.textures);
  if (domain.names == NamesOf::kMedia) return read_medium_name(field, *names.media);
  if (domain.names == NamesOf::kGrids) return read_grid_name(field, *names.grids);
  return read_whole(field, domain.range);
}

std::string read_name(const Field& field, const Domain& domain) {
  std::string name = read_text(field);
  if (name.empty() || domain.accepts_text(name)) return name;
  field.must_be(phrase_of(domain.range));
  return {};
}

Rgb read_plain_color(const Field& field, const Domain& domain) {
  const JsonValue& value = field.value();
  if (domain.hint.empty() || value.get_if<JsonValue::Number>() || value.get_if<JsonValue::Array>())
    return read_color(field, domain.range);
  field.mistake(
      fmt::format("must be a number or a list of 3 numbers, got {}{}", value.describe(), domain.hint));
  return {};
}

ColorParameter read_parameter(const Field& field, const Domain& domain, const KnownNames& names,
                              Track<Rgb>& track) {
  if (is_text(field)) {
    field.must_be(fmt::format("a number, a list of 3 numbers or {}", domains::kTextureObject));
    return {};
  }
  if (is_constant(field)) return {read_animated(field, track, read_color, domain.range), -1};
  const ObjectReader object(field, kTexturedColor);
  ColorParameter color;
  color.value = read_animated_or(object, "tint", color.value, track, read_color, domain.range);
  color.texture = read_or(object, "texture", color.texture, read_texture_name, *names.textures);
  return color;
}

ScalarParameter read_parameter(const Field& field, const Domain& domain, const KnownNames& names,
                               Track<float>& track) {
  if (is_text(field)) {
    field.must_be(fmt::format("{}, or {}", unquoted_number(domain.range), domains::kTextureObject));
    return 1;
  }
  if (is_constant(field)) return read_animated(field, track, read_float, domain.range);
  const ObjectReader object(field, kTexturedNumber);
  ScalarParameter scalar = 1;
  scalar.value = read_animated_or(object, "scale", scalar.value, track, read_float, domain.range);
  scalar.texture = read_or(object, "texture", scalar.texture, read_texture_name, *names.textures);
  return scalar;
}

}  // namespace tessera::core
