// SPDX-License-Identifier: Apache-2.0
// The layers of an image as viewers see them: three channels that a screen can show, and the values of a
// pixel. Pure functions.
#pragma once

#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "core/film/layers.hpp"
#include "core/image/image.hpp"

namespace tessera::view {

// A layer, or a light group by its name.
struct ImageLayer {
  ImageLayer(core::Layer of_layer) : layer(of_layer) {}  // NOLINT: a layer is one
  explicit ImageLayer(std::string group_name) : group(std::move(group_name)) {}
  std::string name() const;
  auto operator<=>(const ImageLayer&) const = default;

  std::optional<core::Layer> layer{};  // nullopt for a light group
  std::string group{};
};

// What is shown of an image; nothing for the beauty.
using ShownLayer = std::optional<ImageLayer>;

// The layer of this name; the beauty if it is empty. INVALID_ARGUMENT names `layer`.
core::Result<ShownLayer> parse_layer(std::string_view name);
// INVALID_ARGUMENT if an image with these layers does not have the shown one.
core::Status check_layer(const core::LayerSet& layers, const ShownLayer& shown);

// As develop_level() of a layer in a film with `layers`, which must have it: a channel alone is gray, two are
// red and green, and ids have the colours of their bits, as bright as the first of them covers the pixel.
// Where means have no meaning, as of depth and ids, a pixel of a level is its first one.
core::Image develop_layer(const core::LayerSet& layers, const ImageLayer& layer, const core::PixelRect& rect,
                          const core::Film::TileSums& sums, int level);

struct LayerValues {
  std::vector<std::string> channels;  // as core::image_channels() names them
  std::vector<float> values;
};
// Of a pixel, in pixels of the whole image, that lies in the tile.
LayerValues layer_values(const core::LayerSet& layers, const ImageLayer& layer, const core::PixelRect& rect,
                         const core::Film::TileSums& sums, int x, int y);

}  // namespace tessera::view
