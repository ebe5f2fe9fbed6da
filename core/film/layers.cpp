// SPDX-License-Identifier: Apache-2.0
#include "core/film/layers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace tessera::core {
namespace {

constexpr std::array<std::string_view, kLayerCount> kLayerNames{
    "alpha",          "direct",        "indirect",        "emission",     "environment",  "albedo",
    "normal",         "depth",         "position",        "uv",           "object_index", "material_index",
    "instance_index", "crypto_object", "crypto_material", "crypto_asset", "samples",      "standard_error"};

}  // namespace

std::string_view layer_name(Layer layer) {
  return kLayerNames[static_cast<std::size_t>(layer)];
}

std::vector<std::string_view> layer_names(LayerSet layers) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < kLayerCount; ++i)
    if (layers.has(static_cast<Layer>(i))) names.push_back(kLayerNames[i]);
  return names;
}

Result<LayerSet> parse_layers(std::string_view text) {
  if (text == "all") return kAllLayers;
  if (text == "none") return LayerSet{};
  LayerSet layers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view name = text.substr(begin, end - begin);
    const auto known = std::find(kLayerNames.begin(), kLayerNames.end(), name);
    if (known == kLayerNames.end())
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("there is no layer '{}': write all, none, or some of {}", name,
                              fmt::join(kLayerNames, ", ")));
    layers = layers.with(static_cast<Layer>(known - kLayerNames.begin()));
    begin = end + 1;
  }
  return layers;
}

std::string layers_text(LayerSet layers) {
  if (layers == kAllLayers) return "all";
  return layers.empty() ? "none" : fmt::format("{}", fmt::join(layer_names(layers), ","));
}

}  // namespace tessera::core
