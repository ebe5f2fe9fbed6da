// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/plugin.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/printable.hpp"
#include "core/base/suggestion.hpp"

namespace tessera::core::mitsuba {
namespace {

std::string shown_node(const Node& node) {
  return fmt::format("<{} type=\"{}\">", tag_of(node.kind), printable(node.type));
}

}  // namespace

std::optional<std::string> Conversion::find_file(const std::string& written) const {
  return builder.find(written, graph.folders);
}

std::string Plugin::shown() const {
  return shown_node(node());
}

const Property* Plugin::property(std::string_view name) const {
  node().visited = true;
  auto& properties = node().properties;
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const Property& p) { return p.name == name && !p.name.empty(); });
  if (found == properties.end()) {
    if (auto& missing = conversion_->missing[type()]; !missing.contains(name)) missing.emplace(name);
    return nullptr;
  }
  found->used = true;
  return &*found;
}

bool Plugin::has(std::string_view name) const {
  return property(name) != nullptr;
}

template <typename T>
const T* Plugin::value(std::string_view name, std::string_view type_name) const {
  const Property* found = property(name);
  if (found == nullptr) return nullptr;
  const T* typed = std::get_if<T>(&found->value);
  if (typed == nullptr) warn(fmt::format("'{}' is no {}; it is left out", name, type_name));
  return typed;
}

double Plugin::number(std::string_view name, double otherwise) const {
  const Property* found = property(name);
  if (found != nullptr)
    if (const auto* whole = std::get_if<std::int64_t>(&found->value)) return static_cast<double>(*whole);
  const double* number = value<double>(name, "number");
  return number == nullptr ? otherwise : *number;
}

std::int64_t Plugin::integer(std::string_view name, std::int64_t otherwise) const {
  const auto* number = value<std::int64_t>(name, "whole number");
  return number == nullptr ? otherwise : *number;
}

float Plugin::real_in(std::string_view name, float otherwise, float least, float most) const {
  const float value = real(name, otherwise), limited = std::clamp(value, least, most);
  if (limited != value)
    warn(fmt::format("range of {}", name),
         fmt::format("'{}' must be from {:g} to {:g}, got {:g}; {:g} is used", name, least, most, value,
                     limited));
  return limited;
}

std::int64_t Plugin::integer_in(std::string_view name, std::int64_t otherwise, std::int64_t least,
                                std::int64_t most) const {
  const std::int64_t value = integer(name, otherwise), limited = std::clamp(value, least, most);
  if (limited != value)
    warn(fmt::format("range of {}", name),
         fmt::format("'{}' must be from {} to {}, got {}; {} is used", name, least, most, value, limited));
  return limited;
}

bool Plugin::flag(std::string_view name, bool otherwise) const {
  const bool* is_set = value<bool>(name, "boolean");
  return is_set == nullptr ? otherwise : *is_set;
}

std::optional<std::string> Plugin::text(std::string_view name) const {
  const auto* string = value<std::string>(name, "string");
  return string == nullptr ? std::nullopt : std::optional(*string);
}

std::optional<Vec3> Plugin::vector(std::string_view name) const {
  const auto* three = value<Vec3>(name, "vector");
  return three == nullptr ? std::nullopt : std::optional(*three);
}

KeyedTransforms Conversion::in_frames(KeyedTransforms keys) const {
  for (KeyedTransform& key : keys) key.frame -= shutter_open;
  return keys;
}

const KeyedTransforms* Plugin::animation(std::string_view name) const {
  const Property* found = property(name);
  return found == nullptr ? nullptr : std::get_if<KeyedTransforms>(&found->value);
}

Transform Plugin::transform(std::string_view name) const {
  if (const auto* keys = animation(name)) {
    if (keys->size() > 1) warn(fmt::format("does not move; the first keyframe of '{}' counts", name));
    return keys->front().transform;
  }
  const auto* map = value<Transform>(name, "transform");
  return map == nullptr ? Transform{} : *map;
}

std::optional<Plugin> Plugin::child(std::string_view name) const {
  const Property* found = property(name);
  const auto* object = found == nullptr ? nullptr : std::get_if<Child>(&found->value);
  if (found != nullptr && object == nullptr) warn(fmt::format("'{}' is no object; it is left out", name));
  return object == nullptr ? std::nullopt : std::optional(Plugin(*conversion_, object->node));
}

std::vector<Plugin> Plugin::children(Kind kind) const {
  node().visited = true;
  std::vector<Plugin> found;
  for (Property& entry : node().properties) {
    const auto* object = std::get_if<Child>(&entry.value);
    if (object == nullptr || conversion_->graph.nodes[object->node].kind != kind) continue;
    entry.used = true;
    found.emplace_back(*conversion_, object->node);
  }
  return found;
}

std::optional<Plugin> Plugin::first_child(Kind kind) const {
  const std::vector<Plugin> all = children(kind);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

std::optional<Rgb> constant_color(const Property& property) {
  if (const auto* rgb = std::get_if<Rgb>(&property.value)) return *rgb;
  if (const auto* number = std::get_if<double>(&property.value))
    return Rgb::gray(static_cast<float>(*number));
  if (const auto* whole = std::get_if<std::int64_t>(&property.value))
    return Rgb::gray(static_cast<float>(*whole));
  return std::nullopt;
}

namespace {

std::optional<Plugin> emitter_of(const Plugin& shape, bool in_volume) {
  for (const Plugin& emitter : shape.children(Kind::kEmitter))
    if ((emitter.type() == "volumelight") == in_volume) return emitter;
  return std::nullopt;
}

}  // namespace

std::optional<Plugin> area_light_of(const Plugin& shape) {
  return emitter_of(shape, false);
}

std::optional<Plugin> volume_light_of(const Plugin& shape) {
  return emitter_of(shape, true);
}

void Plugin::ignore(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) property(name);
}

void Plugin::ignore(Kind kind) const {
  for (Property& entry : node().properties) {
    const auto* object = std::get_if<Child>(&entry.value);
    if (object != nullptr && conversion_->graph.nodes[object->node].kind == kind) entry.used = true;
  }
}

void Plugin::ignore_all() const {
  for (Property& entry : node().properties) entry.used = true;
}

void Plugin::warn(std::string_view kind, std::string_view what) const {
  conversion_->builder.warn(file(), where().line, fmt::format("{} {}", type(), kind),
                            [&] { return fmt::format("{}: {}", shown(), what); });
}

namespace {

// "; did you mean 'radiance'?" if a parameter that the node lacks has a similar name.
std::string similar_parameter(const Conversion& conversion, const Node& node, std::string_view name) {
  const auto missing = conversion.missing.find(node.type);
  if (missing == conversion.missing.end()) return "";
  std::vector<std::string_view> known(missing->second.begin(), missing->second.end());
  std::erase_if(known, [&](std::string_view each) {
    return std::any_of(node.properties.begin(), node.properties.end(),
                       [&](const Property& property) { return property.name == each; });
  });
  return similar_name(name, known) ? suggestion(name, known) : "";
}

}  // namespace

void warn_of_unused(Conversion& conversion) {
  const SceneGraph& graph = conversion.graph;
  for (const Node& node : graph.nodes) {
    if (!node.visited) continue;
    for (const Property& property : node.properties) {
      if (property.used) continue;
      const auto* child = std::get_if<Child>(&property.value);
      const bool is_parameter = child == nullptr || !property.name.empty();
      const std::string what = is_parameter ? fmt::format("the parameter {}", in_quotes(property.name))
                                            : shown_node(graph.nodes[child->node]);
      conversion.builder.warn(graph.files[property.where.file], property.where.line,
                              fmt::format("unused {} {}", node.type, what), [&] {
                                return fmt::format(
                                    "{}: {} is ignored{}", shown_node(node), what,
                                    is_parameter ? similar_parameter(conversion, node, property.name) : "");
                              });
    }
  }
}

}  // namespace tessera::core::mitsuba
