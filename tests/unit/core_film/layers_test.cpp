// SPDX-License-Identifier: Apache-2.0
// The channels of layers in a film: names, encodings, sums in any order, and what they develop into.
#include "core/film/layers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <random>

#include "core/film/cryptomatte.hpp"
#include "core/film/develop.hpp"

namespace tessera::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Layers, AreNamedOnCommandLines) {
  for (const std::string_view name : layer_names()) {
    const auto one = parse_layers(name);
    ASSERT_TRUE(one) << name;
    EXPECT_EQ(layers_text(*one), name);
  }
  EXPECT_EQ(parse_layers("all").value(), kAllLayers);
  EXPECT_TRUE(parse_layers("none").value().empty());
  EXPECT_EQ(layers_text(kAllLayers), "all");
  EXPECT_EQ(layers_text({}), "none");
  EXPECT_EQ(parse_layers("depth,alpha").value(), LayerSet{}.with(Layer::kAlpha).with(Layer::kDepth));
  EXPECT_EQ(layers_text(parse_layers("depth,alpha").value()), "alpha,depth");
  for (const char* const wrong : {"", "Alpha", "alpha,", "alpha,all", "beauty"})
    EXPECT_THAT(parse_layers(wrong).error().message, HasSubstr("object_index")) << wrong;
  EXPECT_THAT(parse_layers("normal,dpeth").error().message,
              HasSubstr("there is no layer 'dpeth'; did you mean 'depth'? Write all,"));
}

TEST(Layers, OfLightGroupsHaveNames) {
  const LayerSet groups = parse_layers("group.key,depth,group.fill-2,group.key").value();
  EXPECT_THAT(groups.groups, ElementsAre("key", "fill-2"));
  EXPECT_EQ(layers_text(groups), "depth,group.key,group.fill-2");
  EXPECT_EQ(parse_layers(layers_text(groups)).value(), groups);
  EXPECT_TRUE(parse_layers("light_groups")->light_groups);
  for (const char* const wrong : {"group.", "group.a.b", "group.a b", "group", "groups.a"})
    EXPECT_FALSE(parse_layers(wrong)) << wrong;
  EXPECT_FALSE(is_group_name(std::string(65, 'a')));
  EXPECT_FALSE((LayerSet{0, false, {"a.b"}}.valid()));
}

TEST(Layers, OfLightGroupsHaveChannelsBehindOthers) {
  LayerSet layers = LayerSet{}.with(Layer::kSamples).with(Layer::kCryptoAsset).with(Layer::kAlpha);
  layers.groups = {"key", "fill"};
  EXPECT_EQ(film_layout(layers).planes(), 8u);
  EXPECT_EQ(first_group_plane(layers, 0), 2u);
  EXPECT_EQ(first_group_plane(layers, 1), 5u);
  EXPECT_EQ(film_layout(layers).plane(5).name, "Combined_fill.R");
  const std::vector<std::string> names = image_channels(layers);
  EXPECT_EQ(names[names.size() - 2], "Combined_fill.B");
  EXPECT_EQ(names.back(), "Debug Sample Count.X");
}

TEST(Layers, HaveTheirChannelsInAFixedOrder) {
  EXPECT_EQ(film_layout({}), rgb_layout());
  const LayerSet some = LayerSet{}.with(Layer::kUv).with(Layer::kAlpha).with(Layer::kSamples);
  std::vector<std::string> names;
  for (const FilmChannel& channel : film_layout(some).channels) names.push_back(channel.name);
  EXPECT_THAT(names, ElementsAre("R", "G", "B", "A", "UV.U", "UV.V"));
  EXPECT_EQ(film_layout(some).planes(), 3u);
  EXPECT_EQ(film_layout(some).sums(10), 30u);
  EXPECT_EQ(first_plane(some, Layer::kAlpha), 0u);
  EXPECT_EQ(first_plane(some, Layer::kUv), 1u);
  EXPECT_THAT(image_channels(some), ElementsAre("R", "G", "B", "A", "UV.U", "UV.V", "Debug Sample Count.X"));
  const std::vector<std::string> all = image_channels(kAllLayers);
  EXPECT_EQ(std::count(all.begin(), all.end(), "CryptoAsset02.a"), 1);
  const std::map<std::string, int> unique = [&] {
    std::map<std::string, int> counts;
    for (const std::string& name : all) ++counts[name];
    return counts;
  }();
  EXPECT_EQ(unique.size(), all.size());
}

TEST(SignedSums, CannotOverflow) {
  const std::uint64_t most = to_signed_word(1e30), least = to_signed_word(-1e30);
  EXPECT_EQ(static_cast<std::int64_t>(most), kMaxSignedSample);
  EXPECT_EQ(static_cast<std::int64_t>(least), -kMaxSignedSample);
  constexpr std::uint32_t kMaxSamples = 1u << 24;
  EXPECT_GT(static_cast<std::int64_t>(most * kMaxSamples), 0);
  EXPECT_LT(static_cast<std::int64_t>(least * kMaxSamples), 0);
  EXPECT_NEAR(mean_signed(most * kMaxSamples, kMaxSamples), 524288, 1e-3);
  EXPECT_EQ(to_signed_word(std::nan("")), 0u);
  EXPECT_NEAR(mean_signed(to_signed_word(-0.75) + to_signed_word(0.25), 2), -0.25, 1e-6);
}

TEST(NearestSums, KeepTheSmallestDistance) {
  const std::uint64_t near = to_nearest_word(1.5f, 7), far = to_nearest_word(2, 9);
  EXPECT_EQ(combine(ChannelEncoding::kNearest, near, far), near);
  EXPECT_EQ(combine(ChannelEncoding::kNearest, far, near), near);
  EXPECT_EQ(combine(ChannelEncoding::kNearest, 0, far), far);
  EXPECT_EQ(nearest_distance(near), 1.5f);
  EXPECT_EQ(nearest_number(near), 7u);
  EXPECT_GT(to_nearest_word(0, 0), near);
  EXPECT_TRUE(std::isinf(nearest_distance(0)));
}

// Samples of a tile as functions of pixel and number, added sample by sample.
FilmTile layered_tile(PixelRect rect, SampleRange range) {
  FilmTile tile(rect, range, kAllLayers);
  const FilmLayout layout = film_layout(kAllLayers);
  const auto width = static_cast<std::uint32_t>(rect.width());
  for (std::size_t plane = 0; plane < layout.planes(); ++plane) {
    const ChannelEncoding encoding = layout.plane(plane).encoding;
    IdCounter ids(rect);
    if (encoding != ChannelEncoding::kIds) tile.planes[plane].resize(rect.pixel_count());
    for (std::uint32_t i = 0; i < rect.pixel_count(); ++i)
      for (std::uint32_t s = range.begin; s < range.end; ++s) {
        const auto x = static_cast<std::uint32_t>(rect.x0) + i % width;
        const auto y = static_cast<std::uint32_t>(rect.y0) + i / width;
        const std::uint32_t mixed = (x * 73856093u) ^ (y * 19349663u) ^ (s * 83492791u) ^
                                    (static_cast<std::uint32_t>(plane) * 2654435761u);
        const double value = static_cast<double>(mixed) / 4e9 - 0.5;
        if (encoding == ChannelEncoding::kIds) {
          ids.add(i, mixed % 300);  // more than a pixel keeps
        } else {
          const std::uint64_t word = encoding == ChannelEncoding::kSigned ? to_signed_word(value)
                                     : encoding == ChannelEncoding::kNearest
                                         ? to_nearest_word(static_cast<float>(value + 1), mixed)
                                     : encoding == ChannelEncoding::kCount ? mixed % 2
                                                                           : std::uint64_t{mixed};
          std::uint64_t& sum = tile.planes[plane][i];
          sum = combine(encoding, sum, word);
        }
      }
    if (encoding == ChannelEncoding::kIds) tile.planes[plane] = ids.take();
    drop_zeros(tile.planes[plane]);
  }
  return tile;
}

TEST(LayeredFilm, DoesNotDependOnHowSamplesWereCutAndOrdered) {
  constexpr std::uint32_t kSpp = 230;
  const TileGrid grid({3, 5, 16, 15}, 8);
  Film whole(grid, kAllLayers);
  whole.add(layered_tile(grid.window(), {0, kSpp}));
  std::mt19937 random(3);
  std::vector<FilmTile> pieces;
  for (int t = 0; t < grid.tile_count(); ++t)
    for (std::uint32_t begin = 0; begin < kSpp;) {
      const std::uint32_t end = std::min(kSpp, begin + 1 + static_cast<std::uint32_t>(random() % 90));
      pieces.push_back(layered_tile(grid.rect(t), {begin, end}));
      begin = end;
    }
  std::shuffle(pieces.begin(), pieces.end(), random);
  Film film(grid, kAllLayers);
  for (const FilmTile& piece : pieces) film.add(piece);
  EXPECT_TRUE(film == whole);
  const FilmLayout layout = film_layout(kAllLayers);
  for (int t = 0; t < grid.tile_count(); ++t) {
    const auto possible = check_planes(layout, whole.tile(t).planes, grid.rect(t), kSpp);
    EXPECT_TRUE(possible) << possible.error().message;
  }
  Film restored(grid, kAllLayers);
  for (int t = 0; t < grid.tile_count(); ++t) restored.restore(t, whole.tile(t));
  EXPECT_TRUE(restored == whole);
}

TEST(LayeredFilm, AppendedTilesEqualOneTile) {
  FilmTile tile = layered_tile({8, 0, 14, 6}, {3, 8});
  tile.append(layered_tile({8, 0, 14, 6}, {8, 21}));
  EXPECT_EQ(tile.planes, layered_tile({8, 0, 14, 6}, {3, 21}).planes);
}

TEST(IdSums, KeepSoManyIdsOfAPixelWithExactCounts) {
  const PixelRect rect{100, 200, 102, 201};
  IdCounter counter(rect);
  for (std::uint32_t id = 0; id <= 200; ++id)
    for (std::uint32_t k = 0; k <= id % 3; ++k) counter.add(1, id);
  counter.add(0, 5);
  const Plane plane = counter.take();
  ASSERT_EQ(plane.size(), 2 * (1 + kMaxIdsPerPixel));
  EXPECT_EQ(plane[0], 5u);
  for (std::size_t i = 2; i < plane.size(); i += 2) {
    EXPECT_EQ(plane[i] >> 32, 1u);
    EXPECT_EQ(plane[i + 1], 1 + static_cast<std::uint32_t>(plane[i]) % 3);
  }
  EXPECT_TRUE(counter.take().empty());
}

TEST(CheckPlanes, RefusesWhatNoSamplesHave) {
  const PixelRect rect{0, 0, 2, 1};
  const LayerSet layers =
      LayerSet{}.with(Layer::kAlpha).with(Layer::kUv).with(Layer::kDepth).with(Layer::kCryptoObject);
  const FilmLayout layout = film_layout(layers);  // A, Depth.Z, UV.U, UV.V, CryptoObject
  const std::uint64_t pixel = std::uint64_t{1} << 32;
  const Planes good{
      {1, 4}, {0, to_nearest_word(1, 0)}, {to_signed_word(-9), 0}, {}, {7, 2, 9, 2, pixel | 7, 1}};
  ASSERT_TRUE(check_planes(layout, good, rect, 4)) << check_planes(layout, good, rect, 4).error().message;
  EXPECT_TRUE(check_planes(layout, {}, rect, 4));
  const auto refused = [&](std::size_t plane, Plane words) {
    Planes planes = good;
    planes[plane] = std::move(words);
    return !check_planes(layout, planes, rect, 4);
  };
  EXPECT_TRUE(refused(0, {1, 5}));
  EXPECT_TRUE(refused(0, {1}));
  EXPECT_TRUE(refused(1, {0, 1}));
  EXPECT_TRUE(refused(2, {0, std::uint64_t{1} << 63}));
  EXPECT_TRUE(refused(4, {7}));
  EXPECT_TRUE(refused(4, {9, 2, 7, 2}));
  EXPECT_TRUE(refused(4, {7, 2, 7, 2}));
  EXPECT_TRUE(refused(4, {7, 2, 9, 3}));
  EXPECT_TRUE(refused(4, {7, 0}));
  EXPECT_TRUE(refused(4, {pixel, 1}));
  EXPECT_TRUE(refused(4, {2 * pixel | 7, 1}));
  EXPECT_FALSE(check_planes(layout, {{}, {}}, rect, 4));
}

TEST(Develop, GivesMeansCoveragesAndTheNearestSurface) {
  const PixelRect rect{0, 0, 2, 1};
  const LayerSet layers = LayerSet{}
                              .with(Layer::kAlpha)
                              .with(Layer::kNormal)
                              .with(Layer::kDepth)
                              .with(Layer::kObjectIndex)
                              .with(Layer::kCryptoObject)
                              .with(Layer::kSamples);
  Film::TileSums sums;
  sums.sums = {std::uint64_t{4} << kFilmFractionBits, 0, 0, 0, 0, 0};
  sums.odd_sums.resize(6);
  sums.samples = 4;
  sums.odd_samples = 2;
  sums.planes = {{3, 0},
                 {to_signed_word(2), 0},
                 {to_signed_word(-1), 0},
                 {},
                 {to_nearest_word(2.5f, 0), 0},
                 {to_nearest_word(2.5f, 6), 0},
                 {77, 1, 99, 2}};
  const std::vector<std::string> names = image_channels(layers);
  std::vector<float> values(2 * names.size());
  develop_layers(layers, rect, sums, values);
  const auto at = [&](std::size_t pixel, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    EXPECT_NE(found, names.end()) << name;
    return values[pixel * names.size() + static_cast<std::size_t>(found - names.begin())];
  };
  EXPECT_EQ(at(0, "R"), 1);
  EXPECT_EQ(at(0, "A"), 0.75f);
  EXPECT_EQ(at(0, "Normal.X"), 0.5f);
  EXPECT_EQ(at(0, "Normal.Y"), -0.25f);
  EXPECT_EQ(at(0, "Depth.Z"), 2.5f);
  EXPECT_EQ(at(1, "Depth.Z"), kNoDepth);
  EXPECT_EQ(at(0, "IndexOB.X"), 6);
  EXPECT_EQ(at(1, "IndexOB.X"), 0);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(at(0, "CryptoObject00.r")), 99u);
  EXPECT_EQ(at(0, "CryptoObject00.g"), 0.5f);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(at(0, "CryptoObject00.b")), 77u);
  EXPECT_EQ(at(0, "CryptoObject00.a"), 0.25f);
  EXPECT_EQ(at(0, "CryptoObject01.r"), 0);
  EXPECT_EQ(at(1, "CryptoObject00.g"), 0);
  EXPECT_EQ(at(1, "Debug Sample Count.X"), 4);
}

TEST(Develop, RowsAreThoseOfTheTiles) {
  const TileGrid grid({0, 0, 11, 10}, 4);
  const LayerSet layers = LayerSet{}.with(Layer::kAlpha).with(Layer::kPosition);
  Film film(grid, layers);
  FilmTile tile(grid.window(), {0, 1}, layers);
  for (Plane& plane : tile.planes) plane.resize(110);
  for (std::size_t i = 0; i < 110; ++i) tile.planes[1][i] = to_signed_word(static_cast<double>(i));
  for (Plane& plane : tile.planes) drop_zeros(plane);
  film.add(tile);
  const auto sums = [&](int index) -> Result<Film::TileSums> { return film.tile(index); };
  LayerRows rows(grid, grid.window(), layers, sums);
  for (const int y : {0, 1, 9, 3, 4}) {
    const auto row = rows.row(y);
    ASSERT_TRUE(row);
    for (int x = 0; x < 11; ++x)
      EXPECT_EQ((*row)[static_cast<std::size_t>(x) * 7 + 4], static_cast<float>(y * 11 + x));
  }
  const PixelRect region{2, 3, 9, 10};
  LayerRows part(grid, region, layers, sums);
  for (const int y : {0, 6, 1, 2}) {
    const auto row = part.row(y);
    ASSERT_TRUE(row);
    for (int x = 0; x < region.width(); ++x)
      EXPECT_EQ((*row)[static_cast<std::size_t>(x) * 7 + 4], static_cast<float>((y + 3) * 11 + x + 2));
  }
  LayerRows broken(grid, grid.window(), layers,
                   [](int) -> Result<Film::TileSums> { return fail(ErrorCode::kDataLoss, "lost"); });
  EXPECT_EQ(broken.row(2).error().message, "lost");
}

// Published test vectors of MurmurHash3_x86_32.
TEST(Cryptomatte, HashesNames) {
  EXPECT_EQ(murmur3_32(""), 0u);
  EXPECT_EQ(murmur3_32("hello"), 0x248bfa47u);
  EXPECT_EQ(murmur3_32("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(murmur3_32("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

TEST(Cryptomatte, IdsAreNormalFloats) {
  EXPECT_EQ(crypto_id("hello"), 0x248bfa47u);
  EXPECT_NE(crypto_id(""), 0u);
  for (int i = 0; i < 5000; ++i)
    EXPECT_TRUE(std::isnormal(std::bit_cast<float>(crypto_id("object " + std::to_string(i)))));
}

TEST(Cryptomatte, ManifestsNameTheIds) {
  const auto attributes =
      crypto_attributes(LayerSet{}.with(Layer::kCryptoMaterial), {{"unused"}, {"b\"", "a", "b\""}, {}});
  ASSERT_EQ(attributes.size(), 4u);
  const std::string key = attributes[0].first.substr(0, attributes[0].first.rfind('/') + 1);
  EXPECT_EQ(key.size(), std::string("cryptomatte/1234567/").size());
  EXPECT_EQ(attributes[0], (std::pair<std::string, std::string>(key + "name", "CryptoMaterial")));
  EXPECT_EQ(attributes[1], (std::pair<std::string, std::string>(key + "hash", "MurmurHash3_32")));
  EXPECT_EQ(attributes[2], (std::pair<std::string, std::string>(key + "conversion", "uint32_to_float32")));
  EXPECT_EQ(attributes[3].second.substr(0, 7), "{\"a\":\"3");
  EXPECT_THAT(attributes[3].second, HasSubstr("\"b\\\"\":\""));
}

}  // namespace
}  // namespace tessera::core
