// SPDX-License-Identifier: Apache-2.0
#include "core/view/shown_layer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "core/film/develop.hpp"
#include "core/view/film_source.hpp"
#include "core/view/tile_statistics.hpp"
#include "tests/support/layered_tile.hpp"

namespace tessera::view {
namespace {

using core::Layer;
using core::LayerSet;
using testing::HasSubstr;

const core::PixelRect kRect{64, 0, 84, 11};

core::FilmTile samples_of(LayerSet layers) {
  core::FilmTile tile(kRect, {0, 5}, layers);
  test::add_made_up_planes(tile);
  return tile;
}

core::Film::TileSums sums_of(LayerSet layers) {
  core::Film film(core::TileGrid(kRect, core::kTilePx), layers);
  film.add(samples_of(layers));
  return film.tile(0);
}

// The channels of a pixel by their names.
float value_of(LayerSet layers, const std::string& name, std::size_t pixel) {
  const std::vector<std::string> names = core::image_channels(layers);
  std::vector<float> values(kRect.pixel_count() * names.size());
  core::develop_layers(layers, kRect, sums_of(layers), values);
  const auto at = std::find(names.begin(), names.end(), name) - names.begin();
  return values[pixel * names.size() + static_cast<std::size_t>(at)];
}

TEST(ShownLayer, IsFoundByItsName) {
  EXPECT_EQ(*parse_layer(""), ShownLayer());
  const core::LayerSet all{core::kAllLayers.bits, false, {"key"}};
  for (const std::string& name : core::layer_names(all)) EXPECT_EQ((*parse_layer(name))->name(), name);
  EXPECT_FALSE(parse_layer("light_groups"));
  for (const char* wrong : {"all", "none", "beauty", "alpha,depth", " alpha"}) {
    const auto refused = parse_layer(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(core::details_of(refused.error()).field, "layer");
  }
}

TEST(ShownLayer, HasThreeChannels) {
  const LayerSet all = core::kAllLayers;
  const auto pixel = [&](Layer layer, std::size_t i) {
    return develop_layer(all, layer, kRect, sums_of(all), 0).pixels.at(i);
  };
  for (const std::size_t i : {0, 37, 219}) {
    const float depth = value_of(all, "Depth.Z", i);
    EXPECT_EQ(pixel(Layer::kDepth, i), (core::Rgb{depth, depth, depth}));
    EXPECT_EQ(pixel(Layer::kNormal, i), (core::Rgb{value_of(all, "Normal.X", i), value_of(all, "Normal.Y", i),
                                                   value_of(all, "Normal.Z", i)}));
    EXPECT_EQ(pixel(Layer::kUv, i), (core::Rgb{value_of(all, "UV.U", i), value_of(all, "UV.V", i), 0}));
    EXPECT_EQ(pixel(Layer::kSamples, i), (core::Rgb{5, 5, 5}));
    const auto id = std::bit_cast<std::uint32_t>(value_of(all, "CryptoObject00.r", i));
    const float red = static_cast<float>(id & 0xff) / 255 * value_of(all, "CryptoObject00.g", i);
    EXPECT_FLOAT_EQ(pixel(Layer::kCryptoObject, i).r, red);
  }
  for (const float value : {develop_layer(all, Layer::kDepth, kRect, {}, 0).pixels[3].r,
                            develop_layer(all, Layer::kAlpha, kRect, {}, 2).pixels[3].g})
    EXPECT_EQ(value, 0) << "there are no samples";
}

TEST(ShownLayer, MayBeALightGroup) {
  LayerSet all = core::kAllLayers;
  all.groups = {"key", "fill"};
  const ShownLayer fill = *parse_layer("group.fill");
  EXPECT_TRUE(check_layer(all, fill));
  const core::Rgb pixel = develop_layer(all, *fill, kRect, sums_of(all), 0).pixels.at(37);
  EXPECT_EQ(pixel, (core::Rgb{value_of(all, "Combined_fill.R", 37), value_of(all, "Combined_fill.G", 37),
                              value_of(all, "Combined_fill.B", 37)}));
  EXPECT_EQ(develop_layer(all, Layer::kSamples, kRect, sums_of(all), 0).pixels.at(37), core::Rgb::gray(5));
  EXPECT_THAT(check_layer(all, *parse_layer("group.rim")).error().message, HasSubstr("and not group.rim"));
}

TEST(ShownLayer, IsCoarseByMeansWhereTheyHaveAMeaning) {
  const core::Film::TileSums sums = sums_of(core::kAllLayers);
  const core::Image normals = develop_layer(core::kAllLayers, Layer::kNormal, kRect, sums, 0);
  const core::Image coarse = develop_layer(core::kAllLayers, Layer::kNormal, kRect, sums, 3);
  ASSERT_EQ(coarse.width, 3);
  ASSERT_EQ(coarse.height, 2);
  double sum = 0;
  for (int y = 8; y < 11; ++y)
    for (int x = 16; x < 20; ++x) sum += static_cast<double>(normals.at(x, y).g);
  EXPECT_FLOAT_EQ(coarse.at(2, 1).g, static_cast<float>(sum / 12));
  const core::Image depths = develop_layer(core::kAllLayers, Layer::kDepth, kRect, sums, 0);
  EXPECT_EQ(develop_layer(core::kAllLayers, Layer::kDepth, kRect, sums, 3).at(2, 1), depths.at(16, 8));
}

TEST(ShownLayer, OfAPixelHasItsChannels) {
  const LayerSet layers = LayerSet{}.with(Layer::kDepth).with(Layer::kNormal);
  FilmSource source("a", core::TileGrid(kRect, core::kTilePx), [] { return JobHeader(); });
  core::Film film(core::TileGrid(kRect, core::kTilePx), layers);
  film.add(samples_of(layers));
  source.attach(film);
  const auto pixel = read_pixel(source, 70, 4, Layer::kNormal);
  ASSERT_TRUE(pixel) << pixel.error().message;
  EXPECT_EQ(pixel->layer->channels, (std::vector<std::string>{"Normal.X", "Normal.Y", "Normal.Z"}));
  EXPECT_EQ(pixel->layer->values[1], value_of(layers, "Normal.Y", 4 * 20 + 6));
  EXPECT_EQ(pixel->samples, 5u);
  EXPECT_THAT(to_json(*pixel),
              HasSubstr(R"(,"layer":{"channels":["Normal.X","Normal.Y","Normal.Z"],"values":[)"));
  EXPECT_THAT(read_pixel(source, 70, 4, Layer::kUv).error().message,
              HasSubstr("layer: the image has only normal, depth, and not uv"));
}

}  // namespace
}  // namespace tessera::view
