// SPDX-License-Identifier: Apache-2.0
#include "core/view/shown_layer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/suggestion.hpp"
#include "core/film/develop.hpp"
#include "core/film/layout.hpp"
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

// Light groups come after the layers of sums and before those that follow from others.
Channels channels_of(const LayerSet& layers, const ImageLayer& shown) {
  const std::vector<std::string> all = core::image_channels(layers);
  if (!shown.layer) {
    const auto first = std::find(all.begin(), all.end(), core::group_channel(shown.group) + ".R");
    return {all.size(), static_cast<std::size_t>(first - all.begin()), 3};
  }
  LayerSet before{layers.bits & ((1U << static_cast<unsigned>(*shown.layer)) - 1)};
  if (*shown.layer >= Layer::kSamples) before.groups = layers.groups;
  const std::size_t first = core::image_channels(before).size();
  return {all.size(), first, core::image_channels(before.with(*shown.layer)).size() - first};
}

bool is_of_ids(const ImageLayer& shown) {
  return shown == Layer::kCryptoObject || shown == Layer::kCryptoMaterial || shown == Layer::kCryptoAsset;
}

// Whether the mean over pixels is of the same kind as their values.
bool has_means(const ImageLayer& shown) {
  return !is_of_ids(shown) && shown != Layer::kDepth && shown != Layer::kObjectIndex &&
         shown != Layer::kMaterialIndex && shown != Layer::kInstanceIndex;
}

core::Rgb colour_of_id(float id, float coverage) {
  const auto bits = std::bit_cast<std::uint32_t>(id);
  const auto channel = [&](int shift) {
    return static_cast<float>(bits >> shift & 0xff) * (1.0f / 255.0f) * coverage;
  };
  return {channel(0), channel(8), channel(16)};
}

core::Rgb shown(const ImageLayer& layer, const float* values, std::size_t count) {
  if (is_of_ids(layer)) return colour_of_id(values[0], values[1]);
  if (count == 1) return {values[0], values[0], values[0]};
  return {values[0], values[1], count > 2 ? values[2] : 0};
}

std::vector<float> develop_all(const LayerSet& layers, const core::PixelRect& rect,
                               const core::Film::TileSums& sums, std::size_t channels) {
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
  if (set && std::has_single_bit(set->bits) && !set->light_groups && set->groups.empty())
    return ShownLayer(static_cast<Layer>(std::countr_zero(set->bits)));
  if (set && set->bits == 0 && !set->light_groups && set->groups.size() == 1)
    return ShownLayer(ImageLayer(set->groups.front()));
  const std::vector<std::string> names = core::layer_names(LayerSet{core::kAllLayers.bits});
  return invalid_layer(fmt::format("must be one of {}, or group.NAME; got {}{}", fmt::join(names, ", "),
                                   core::in_quotes(name), core::suggestion(name, {names.begin(), names.end()})));
}

std::string ImageLayer::name() const {
  return layer ? std::string(core::layer_name(*layer)) : "group." + group;
}

core::Status check_layer(const LayerSet& layers, const ShownLayer& shown) {
  if (!shown || (shown->layer ? layers.has(*shown->layer) : layers.has_group(shown->group))) return {};
  const std::string there =
      layers.empty() ? "no layers" : fmt::format("only {}", fmt::join(core::layer_names(layers), ", "));
  return invalid_layer(fmt::format("the image has {}, and not {}", there, shown->name()));
}

core::Image develop_layer(const LayerSet& layers, const ImageLayer& layer, const core::PixelRect& rect,
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

LayerValues layer_values(const LayerSet& layers, const ImageLayer& layer, const core::PixelRect& rect,
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
