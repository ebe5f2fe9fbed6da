// SPDX-License-Identifier: Apache-2.0
// The channels of OpenEXR files as layers: which channels a name means, and the names of all. Pure functions.
#pragma once

#include <ImfChannelList.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

// The names of the red, green, blue and alpha channels; for gray all three colours have the same name.
struct ChannelNames {
  std::array<std::string, 3> colors;
  std::string alpha;
};

// The channels of a layer ("Normal", "view.Normal"), of up to three components, or a channel by its whole
// name ("Depth.Z"), which makes a gray image.
std::optional<ChannelNames> layer_channels(const Imf::ChannelList& channels, const std::string& layer);

// The channels of the image itself, or of the first layer with colour channels ("view.combined.R").
std::optional<ChannelNames> color_channels(const Imf::ChannelList& channels);

// Whether the image is luminance with chroma.
bool has_chroma(const Imf::ChannelList& channels);

// What image_layers() of codecs.hpp returns.
std::vector<std::string> layers_of(const Imf::ChannelList& channels);

// Says which layers there are, and which one may be meant.
tl::unexpected<Error> no_such_layer(const Imf::ChannelList& channels, std::string_view layer);

}  // namespace tessera::core
