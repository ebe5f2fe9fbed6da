// SPDX-License-Identifier: Apache-2.0
#include "core/film/layers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "core/base/suggestion.hpp"

namespace tessera::core {
namespace {

constexpr std::array<std::string_view, kLayerCount> kLayerNames{
    "alpha",          "direct",        "indirect",        "emission",     "environment",  "albedo",
    "normal",         "depth",         "position",        "uv",           "object_index", "material_index",
    "instance_index", "crypto_object", "crypto_material", "crypto_asset", "samples",      "standard_error"};

constexpr std::string_view kLightGroups = "light_groups", kGroupPrefix = "group.";

tl::unexpected<Error> no_layer(std::string_view name) {
  std::vector<std::string_view> known(kLayerNames.begin(), kLayerNames.end());
  known.push_back(kLightGroups);
  const std::string near = suggestion(name, known);
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("there is no layer {}{}rite all, none, or some of {}, and group.NAME for a light group",
                          in_quotes(name), near.empty() ? ": w" : near + " W", fmt::join(layer_names(), ", ")));
}

// Whether there is such a layer.
bool add_layer(std::string_view name, LayerSet& layers) {
  if (name == kLightGroups) return layers.light_groups = true;
  if (name.starts_with(kGroupPrefix)) {
    const std::string_view group = name.substr(kGroupPrefix.size());
    if (!is_group_name(group)) return false;
    if (!layers.has_group(group)) layers.groups.emplace_back(group);
    return true;
  }
  const auto known = std::find(kLayerNames.begin(), kLayerNames.end(), name);
  if (known == kLayerNames.end()) return false;
  layers = layers.with(static_cast<Layer>(known - kLayerNames.begin()));
  return true;
}

}  // namespace

std::string_view layer_name(Layer layer) {
  return kLayerNames[static_cast<std::size_t>(layer)];
}

bool is_group_name(std::string_view name) {
  constexpr std::size_t kMaxLength = 64;
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= kMaxLength && std::all_of(name.begin(), name.end(), is_allowed);
}

bool LayerSet::has_group(std::string_view name) const {
  return std::find(groups.begin(), groups.end(), name) != groups.end();
}

bool LayerSet::valid() const {
  return bits >> kLayerCount == 0 && groups.size() <= kMaxLightGroups &&
         std::all_of(groups.begin(), groups.end(), is_group_name);
}

std::vector<std::string> layer_names(const LayerSet& layers) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kLayerCount; ++i)
    if (layers.has(static_cast<Layer>(i))) names.emplace_back(kLayerNames[i]);
  if (layers.light_groups) names.emplace_back(kLightGroups);
  for (const std::string& group : layers.groups) names.push_back(std::string(kGroupPrefix) + group);
  return names;
}

Result<LayerSet> parse_layers(std::string_view text) {
  if (text == "all") return kAllLayers;
  if (text == "none") return LayerSet{};
  LayerSet layers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view name = text.substr(begin, end - begin);
    if (!add_layer(name, layers)) return no_layer(name);
    begin = end + 1;
  }
  return layers;
}

std::string layers_text(const LayerSet& layers) {
  if (layers.bits == kAllLayers.bits && layers.groups.empty()) return "all";
  return layers.empty() ? "none" : fmt::format("{}", fmt::join(layer_names(layers), ","));
}

}  // namespace tessera::core
