// SPDX-License-Identifier: Apache-2.0
#include "core/view/shown_layer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/printable.hpp"
#include "core/film/develop.hpp"
#include "core/view/tile_pixels.hpp"

namespace tessera::view {
namespace {

using core::Layer;
using core::LayerSet;

tl::unexpected<core::Error> invalid_layer(std::string sentence) {
  return core::fail(core::Error{core::ErrorCode::kInvalidArgument, "layer: " + std::move(sentence)}.with(
      core::ErrorDetails{.field = "layer"}));
}

// The channels of a layer among those of all layers.
struct Channels {
  std::size_t all, first, count;
};

Channels channels_of(LayerSet layers, Layer layer) {
  const LayerSet before{layers.bits & ((1U << static_cast<unsigned>(layer)) - 1)};
  const std::size_t first = core::image_channels(before).size();
  return {core::image_channels(layers).size(), first,
          core::image_channels(before.with(layer)).size() - first};
}

bool is_of_ids(Layer layer) {
  return layer == Layer::kCryptoObject || layer == Layer::kCryptoMaterial || layer == Layer::kCryptoAsset;
}

// Whether the mean over pixels is of the same kind as their values.
bool has_means(Layer layer) {
  return !is_of_ids(layer) && layer != Layer::kDepth && layer != Layer::kObjectIndex &&
         layer != Layer::kMaterialIndex && layer != Layer::kInstanceIndex;
}

core::Rgb colour_of_id(float id, float coverage) {
  const auto bits = std::bit_cast<std::uint32_t>(id);
  const auto channel = [&](int shift) {
    return static_cast<float>(bits >> shift & 0xff) * (1.0f / 255.0f) * coverage;
  };
  return {channel(0), channel(8), channel(16)};
}

core::Rgb shown(Layer layer, const float* values, std::size_t count) {
  if (is_of_ids(layer)) return colour_of_id(values[0], values[1]);
  if (count == 1) return {values[0], values[0], values[0]};
  return {values[0], values[1], count > 2 ? values[2] : 0};
}

std::vector<float> develop_all(LayerSet layers, const core::PixelRect& rect, const core::Film::TileSums& sums,
                               std::size_t channels) {
  std::vector<float> values(rect.pixel_count() * channels);
  core::develop_layers(layers, rect, sums, values);
  return values;
}

core::Rgb block_mean_of(const core::Image& image, const core::PixelRect& block) {
  double r = 0, g = 0, b = 0;
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; ++x) {
      const core::Rgb& pixel = image.at(x, y);
      r += static_cast<double>(pixel.r);
      g += static_cast<double>(pixel.g);
      b += static_cast<double>(pixel.b);
    }
  }
  const auto count = static_cast<double>(block.pixel_count());
  return {static_cast<float>(r / count), static_cast<float>(g / count), static_cast<float>(b / count)};
}

core::Image at_level(const core::Image& image, int level, bool with_means) {
  core::Image coarse(level_size(image.width, level), level_size(image.height, level));
  const int side = 1 << level;
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) {
      const core::PixelRect block{x * side, y * side, std::min((x + 1) * side, image.width),
                                  std::min((y + 1) * side, image.height)};
      coarse.at(x, y) = with_means ? block_mean_of(image, block) : image.at(block.x0, block.y0);
    }
  }
  return coarse;
}

}  // namespace

core::Result<ShownLayer> parse_layer(std::string_view name) {
  if (name.empty()) return ShownLayer();
  const auto set = core::parse_layers(name);
  if (set && std::has_single_bit(set->bits))
    return ShownLayer(static_cast<Layer>(std::countr_zero(set->bits)));
  return invalid_layer(fmt::format("must be one of {}; got '{}'", fmt::join(core::layer_names(), ", "),
                                   core::printable(std::string(name))));
}

core::Status check_layer(LayerSet layers, const ShownLayer& layer) {
  if (!layer || layers.has(*layer)) return {};
  const std::string there =
      layers.empty() ? "no layers" : fmt::format("only {}", fmt::join(core::layer_names(layers), ", "));
  return invalid_layer(fmt::format("the image has {}, and not {}", there, core::layer_name(*layer)));
}

core::Image develop_layer(LayerSet layers, Layer layer, const core::PixelRect& rect,
                          const core::Film::TileSums& sums, int level) {
  core::Image image(rect.width(), rect.height());
  if (sums.samples > 0) {
    const Channels channels = channels_of(layers, layer);
    const std::vector<float> values = develop_all(layers, rect, sums, channels.all);
    const float* next = values.data() + channels.first;
    for (core::Rgb& pixel : image.pixels) {
      pixel = shown(layer, next, channels.count);
      next += channels.all;
    }
  }
  return level == 0 ? image : at_level(image, level, has_means(layer));
}

LayerValues layer_values(LayerSet layers, Layer layer, const core::PixelRect& rect,
                         const core::Film::TileSums& sums, int x, int y) {
  const Channels channels = channels_of(layers, layer);
  const std::vector<std::string> names = core::image_channels(layers);
  const auto first = names.begin() + static_cast<std::ptrdiff_t>(channels.first);
  LayerValues pixel{{first, first + static_cast<std::ptrdiff_t>(channels.count)}, {}};
  pixel.values.resize(channels.count);
  if (sums.samples == 0) return pixel;
  const std::vector<float> values = develop_all(layers, rect, sums, channels.all);
  const auto number = static_cast<std::size_t>(y - rect.y0) * static_cast<std::size_t>(rect.width()) +
                      static_cast<std::size_t>(x - rect.x0);
  std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(number * channels.all + channels.first),
              channels.count, pixel.values.begin());
  return pixel;
}

}  // namespace tessera::view
