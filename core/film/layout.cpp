// SPDX-License-Identifier: Apache-2.0
#include "core/film/layout.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace tessera::core {
namespace {

// The channels of a film that a layer needs.
struct FilmChannels {
  Layer layer;
  std::string_view name;
  std::string_view components;  // one character each; empty: a single channel of that name
  ChannelEncoding encoding;
};

constexpr std::array<FilmChannels, 16> kFilmChannels{{
    {Layer::kAlpha, "A", "", ChannelEncoding::kCount},
    {Layer::kDirect, "Direct", "RGB", ChannelEncoding::kSum},
    {Layer::kIndirect, "Indirect", "RGB", ChannelEncoding::kSum},
    {Layer::kEmission, "Emit", "RGB", ChannelEncoding::kSum},
    {Layer::kEnvironment, "Env", "RGB", ChannelEncoding::kSum},
    {Layer::kAlbedo, "DiffCol", "RGB", ChannelEncoding::kSum},
    {Layer::kNormal, "Normal", "XYZ", ChannelEncoding::kSigned},
    {Layer::kDepth, "Depth", "Z", ChannelEncoding::kNearest},
    {Layer::kPosition, "Position", "XYZ", ChannelEncoding::kSigned},
    {Layer::kUv, "UV", "UV", ChannelEncoding::kSigned},
    {Layer::kObjectIndex, "IndexOB", "X", ChannelEncoding::kNearest},
    {Layer::kMaterialIndex, "IndexMA", "X", ChannelEncoding::kNearest},
    {Layer::kInstanceIndex, "InstanceID", "X", ChannelEncoding::kNearest},
    {Layer::kCryptoObject, "CryptoObject", "", ChannelEncoding::kIds},
    {Layer::kCryptoMaterial, "CryptoMaterial", "", ChannelEncoding::kIds},
    {Layer::kCryptoAsset, "CryptoAsset", "", ChannelEncoding::kIds},
}};

void append_channels(const FilmChannels& of_layer, std::vector<FilmChannel>& channels) {
  if (of_layer.components.empty()) channels.push_back({std::string(of_layer.name), of_layer.encoding});
  for (const char component : of_layer.components)
    channels.push_back({std::string(of_layer.name) + "." + component, of_layer.encoding});
}

}  // namespace

std::size_t FilmLayout::radiance_channels() const {
  return static_cast<std::size_t>(std::count_if(
      channels.begin(), channels.end(),
      [](const FilmChannel& channel) { return channel.encoding == ChannelEncoding::kRadiance; }));
}

const FilmLayout& rgb_layout() {
  static const FilmLayout kRgb{{{"R"}, {"G"}, {"B"}}};
  return kRgb;
}

FilmLayout film_layout(const LayerSet& layers) {
  FilmLayout layout = rgb_layout();
  for (const FilmChannels& of_layer : kFilmChannels)
    if (layers.has(of_layer.layer)) append_channels(of_layer, layout.channels);
  for (const std::string& group : layers.groups)
    append_channels({{}, group_channel(group), "RGB", ChannelEncoding::kSum}, layout.channels);
  return layout;
}

std::size_t first_plane(const LayerSet& layers, Layer layer) {
  std::size_t planes = 0;
  for (const FilmChannels& of_layer : kFilmChannels) {
    if (of_layer.layer == layer) break;
    if (layers.has(of_layer.layer)) planes += std::max<std::size_t>(of_layer.components.size(), 1);
  }
  return planes;
}

std::size_t first_group_plane(const LayerSet& layers, std::size_t group) {
  constexpr std::size_t kColors = 3;
  return film_layout(layers).planes() - kColors * (layers.groups.size() - group);
}

std::string group_channel(std::string_view group) {
  return "Combined_" + std::string(group);
}

}  // namespace tessera::core
