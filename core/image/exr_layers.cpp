// SPDX-License-Identifier: Apache-2.0
#include "core/image/exr_layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <set>

#include "core/base/suggestion.hpp"

namespace tessera::core {
namespace {

bool has(const Imf::ChannelList& channels, const std::string& name) {
  return channels.findChannel(name) != nullptr;
}

std::vector<std::string> names_of(const Imf::ChannelList& channels) {
  std::vector<std::string> names;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel)
    names.emplace_back(channel.name());
  return names;
}

// The layer to which a channel belongs with others, or the channel's own name.
std::string layer_of(const Imf::ChannelList& channels, const std::string& channel) {
  const std::string layer = channel.substr(0, std::min(channel.rfind('.'), channel.size()));
  if (layer.empty()) return channel;
  const auto names = layer_channels(channels, layer);
  return names && std::ranges::count(names->colors, channel) > 0 ? layer : channel;
}

// As most layers are written in files.
std::string capitalised(std::string_view name) {
  std::string text(name);
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string listing(const std::vector<std::string>& layers) {
  std::string text;
  for (const std::string& layer : layers)
    if (!layer.empty()) text += (text.empty() ? "" : ", ") + in_quotes(layer);
  return text;
}

}  // namespace

std::optional<ChannelNames> layer_channels(const Imf::ChannelList& channels, const std::string& layer) {
  if (has(channels, layer)) return ChannelNames{{layer, layer, layer}, ""};
  for (const std::string_view components : {"RGB", "XYZ", "rgb", "UVA"}) {
    ChannelNames names;
    std::size_t found = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      names.colors[i] = layer + "." + components[i];
      if (found == i && has(channels, names.colors[i])) ++found;
    }
    if (found == 3 || (found == 2 && components == "UVA")) {
      if (found == 2) names.colors[2].clear();
      return names;
    }
  }
  for (const char component : {'X', 'Z', 'V', 'Y'})
    if (const std::string name = layer + "." + component; has(channels, name))
      return ChannelNames{{name, name, name}, ""};
  return std::nullopt;
}

std::optional<ChannelNames> color_channels(const Imf::ChannelList& channels) {
  const auto of_layer = [&](const std::string& layer,
                            std::string_view rgba = "RGBA") -> std::optional<ChannelNames> {
    const auto name = [&](std::size_t i) { return layer + rgba[i]; };
    if (!has(channels, name(0)) || !has(channels, name(1)) || !has(channels, name(2))) return std::nullopt;
    return ChannelNames{{name(0), name(1), name(2)}, name(3)};
  };
  if (auto names = of_layer("")) return names;
  if (has(channels, "Y")) return ChannelNames{{"Y", "Y", "Y"}, "A"};
  if (auto names = of_layer("", "rgba")) return names;
  for (const std::string& name : names_of(channels)) {
    if (!name.ends_with(".R")) continue;
    if (auto names = of_layer(name.substr(0, name.size() - 1))) return names;
  }
  return std::nullopt;
}

bool has_chroma(const Imf::ChannelList& channels) {
  return has(channels, "RY") || has(channels, "BY");
}

std::vector<std::string> layers_of(const Imf::ChannelList& channels) {
  std::vector<std::string> layers;
  std::set<std::string> listed;  // channels
  const auto colors = color_channels(channels);
  if (colors && colors->colors[0].find('.') == std::string::npos) {
    layers.emplace_back();
    listed.insert(colors->colors.begin(), colors->colors.end());
    if (has_chroma(channels) && colors->colors[0] == "Y") listed.insert({"RY", "BY"});
  }
  for (const std::string& channel : names_of(channels)) {
    if (listed.contains(channel)) continue;
    layers.push_back(layer_of(channels, channel));
    const auto names = layer_channels(channels, layers.back());
    listed.insert(names->colors.begin(), names->colors.end());
  }
  return layers;
}

tl::unexpected<Error> no_such_layer(const Imf::ChannelList& channels, std::string_view layer) {
  const std::vector<std::string> layers = layers_of(channels), names = names_of(channels);
  std::vector<std::string_view> known(layers.begin(), layers.end());
  known.insert(known.end(), names.begin(), names.end());
  if (listing(layers).empty()) return fail(ErrorCode::kInvalidArgument, "has no layers");
  const auto is_near = [](const std::string& text) { return text.find("did you mean") != std::string::npos; };
  std::string near = suggestion(layer, known);
  if (!is_near(near)) near = suggestion(capitalised(layer), known);
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("has no layer or channel {}{} layers are {}", in_quotes(layer),
                          is_near(near) ? near + " Its" : "; its", listing(layers)));
}

}  // namespace tessera::core
