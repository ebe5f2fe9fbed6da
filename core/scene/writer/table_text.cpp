// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/table_text.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace tessera::core {
namespace {

std::string name_text(int index, const std::vector<std::string>& names) {
  return index < 0 ? std::string() : json_text::text(names[static_cast<std::size_t>(index)]);
}

std::string textured_text(int texture, std::string_view factor, std::string value, const SceneNames& names) {
  return json_text::Object()
      .add("texture", name_text(texture, names.textures))
      .add_unless(json_text::number(1.0f), factor, std::move(value))
      .on_one_line();
}

}  // namespace

std::string value_text(bool value, const Domain& domain, const SceneNames&) {
  return domain.words.empty() ? json_text::boolean(value) : json_text::text(domain.words[value ? 0 : 1]);
}
std::string value_text(int value, const Domain& domain, const SceneNames& names) {
  if (domain.names == NamesOf::kTextures) return name_text(value, names.textures);
  if (domain.names == NamesOf::kMedia) return name_text(value, names.media);
  if (domain.names == NamesOf::kGrids) return name_text(value, names.grids);
  return fmt::format("{}", value);
}
std::string value_text(float value, const Domain&, const SceneNames&) {
  return json_text::number(value);
}
std::string value_text(Vec2 value, const Domain&, const SceneNames&) {
  return json_text::vector(value);
}
std::string value_text(Vec3 value, const Domain&, const SceneNames&) {
  return json_text::vector(value);
}
std::string value_text(Rgb value, const Domain&, const SceneNames&) {
  return json_text::color(value);
}
std::string value_text(const std::string& value, const Domain&, const SceneNames&) {
  return value.empty() ? std::string() : json_text::text(value);
}

std::string parameter_text(const ColorParameter& parameter, const SceneNames& names,
                           const Track<Rgb>& track) {
  std::string value = animated_text(parameter.value, track, json_text::color);
  return parameter.texture < 0 ? value : textured_text(parameter.texture, "tint", std::move(value), names);
}

std::string parameter_text(const ScalarParameter& parameter, const SceneNames& names,
                           const Track<float>& track) {
  std::string value =
      animated_text(parameter.value, track, [](float number) { return json_text::number(number); });
  return parameter.texture < 0 ? value : textured_text(parameter.texture, "scale", std::move(value), names);
}

}  // namespace tessera::core
