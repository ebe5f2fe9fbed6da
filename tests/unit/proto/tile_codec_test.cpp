// SPDX-License-Identifier: Apache-2.0
#include "proto/tile_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>
#include <zstd.h>

#include <random>
#include <string>

#include "proto/tile_planes.hpp"
#include "tests/support/layered_tile.hpp"

namespace tessera::proto {
namespace {

using core::ErrorCode;
using ::testing::HasSubstr;

core::FilmTile some_tile(core::PixelRect rect, core::SampleRange range, std::uint64_t seed) {
  core::FilmTile tile(rect, range);
  std::mt19937_64 random(seed);
  for (auto& sum : tile.sums) sum = random() >> (random() % 64);
  for (auto& sum : tile.odd_sums) sum = random() >> (random() % 64);
  tile.counters = {.samples = rect.pixel_count() * range.count(),
                   .closest_hit_rays = 7,
                   .shadow_rays = 5,
                   .non_finite_samples = 1,
                   .saturated_samples = 1,
                   .first_non_finite = core::SampleId{rect.x0, rect.y0, range.begin}};
  return tile;
}

v1::RenderedItem some_message() {
  return encode_tile(some_tile({64, 0, 128, 37}, {3, 8}, 1));
}

std::string zstd_frame(const std::string& raw) {
  std::string frame(ZSTD_compressBound(raw.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), 1));
  return frame;
}

// The whole sums one after the other, as bytes.
std::string in_a_row(const core::FilmTile& tile) {
  std::string raw;
  for (const auto* sums : {&tile.sums, &tile.odd_sums})
    raw.append(reinterpret_cast<const char*>(sums->data()), sums->size() * sizeof(std::uint64_t));
  return raw;
}

core::FilmTile tile_with_layers(core::LayerSet layers) {
  core::FilmTile tile = some_tile({64, 0, 128, 37}, {3, 8}, 1);
  tile.layers = layers;
  test::add_made_up_planes(tile);
  return tile;
}

void expect_refused(const v1::RenderedItem& message, const std::string& reason) {
  const auto tile = decode_tile(message);
  ASSERT_FALSE(tile.has_value());
  EXPECT_EQ(tile.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(tile.error().message, HasSubstr(reason));
}

TEST(TileCodec, GivesBackThePlanesOfLayers) {
  for (const core::LayerSet layers :
       {core::kAllLayers, core::LayerSet{}.with(core::Layer::kSamples),
        core::LayerSet{}.with(core::Layer::kCryptoAsset).with(core::Layer::kDepth)}) {
    const core::FilmTile tile = tile_with_layers(layers);
    const v1::RenderedItem message = encode_tile(tile);
    const auto back = decode_tile(message, layers);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->planes, tile.planes);
    EXPECT_EQ(back->layers, layers);
    EXPECT_EQ(back->sums, tile.sums);
    std::uint64_t words = 2 * tile.sums.size();
    for (const core::Plane& plane : tile.planes) words += plane.size();
    EXPECT_EQ(claimed_bytes(message), 8 * words);
    if (tile.planes.empty()) continue;
    EXPECT_FALSE(decode_tile(message)) << "of a job without layers";
    EXPECT_FALSE(decode_tile(some_message(), layers));
  }
}

TEST(TileCodec, APlaneIsOfTheTile) {
  const core::LayerSet layers = core::LayerSet{}.with(core::Layer::kDepth).with(core::Layer::kCryptoObject);
  const v1::RenderedItem message = encode_tile(tile_with_layers(layers));
  for (const std::uint32_t words : {1U, 64U * 37U - 1, 64U * 37U * 2 * 5 + 2, 0xffffffffU}) {
    for (int plane = 0; plane < 2; ++plane) {
      v1::RenderedItem wrong = message;
      wrong.set_plane_words(plane, words);
      EXPECT_FALSE(decode_tile(wrong, layers)) << plane << ' ' << words;
    }
  }
}

// Receivers refuse so many sums, but encoding them must not write beyond the buffer.
TEST(TileCodec, HasRoomForMoreThanOneTile) {
  const core::FilmTile tile = some_tile({0, 0, 256, 192}, {0, 2}, 1);
  const v1::RenderedItem message = encode_tile(tile);
  const auto planes = decode_planes(message.planes_zstd(), tile.sums.size());
  ASSERT_TRUE(planes);
  EXPECT_EQ(planes->sums, tile.sums);
  EXPECT_EQ(planes->odd_sums, tile.odd_sums);
  expect_refused(message, "must lie in one tile");
}

TEST(TileCodec, GivesBackEveryBit) {
  std::uint64_t seed = 0;
  for (const core::PixelRect rect : {core::PixelRect{0, 0, 64, 64}, {64, 128, 65, 129}, {0, 448, 64, 450}}) {
    const core::FilmTile tile = some_tile(rect, {10, 13}, ++seed);
    const auto back = decode_tile(encode_tile(tile));
    ASSERT_TRUE(back.has_value()) << back.error().message;
    EXPECT_EQ(back->rect, tile.rect);
    EXPECT_EQ(back->range, tile.range);
    EXPECT_EQ(back->sums, tile.sums);
    EXPECT_EQ(back->odd_sums, tile.odd_sums);
    EXPECT_EQ(back->counters, tile.counters);
  }
}

// The layout that the protocol promises to programs in other languages.
TEST(TileCodec, WritesPlanesAndTheChecksumOfTheSums) {
  core::FilmTile tile({0, 0, 1, 1}, {0, 2});
  tile.sums = {0x0102030405060708, 2, 3};
  tile.odd_sums = {4, 5, 6};
  tile.counters.samples = 2;
  const v1::RenderedItem message = encode_tile(tile);
  const std::string& frame = message.planes_zstd();
  std::string planes(48, '\0');
  ASSERT_EQ(ZSTD_decompress(planes.data(), planes.size(), frame.data(), frame.size()), 48u);
  EXPECT_EQ(planes.substr(0, 12), std::string("\x08\x02\x03\x04\x05\x06\x07\0\0\0\0\0", 12));
  EXPECT_EQ(message.sums_xxh3(), XXH3_64bits(in_a_row(tile).data(), 48));
  EXPECT_TRUE(message.sums_zstd().empty());
}

TEST(TileCodec, ReadsWhatEarlierBuildsSent) {
  const core::FilmTile tile = some_tile({64, 0, 128, 37}, {3, 8}, 2);
  v1::RenderedItem message = encode_tile(tile);
  message.clear_planes_zstd();
  message.set_sums_zstd(zstd_frame(in_a_row(tile)));
  const auto back = decode_tile(message);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->sums, tile.sums);
  EXPECT_EQ(back->odd_sums, tile.odd_sums);
  message.set_sums_zstd(zstd_frame(in_a_row(tile).substr(8)));
  expect_refused(message, "sums_zstd: its sums are no complete frame of 113664 bytes");
}

TEST(TileCodec, RefusesEveryTruncation) {
  const v1::RenderedItem whole = some_message();
  const std::size_t size = whole.planes_zstd().size();
  for (std::size_t kept = 0; kept < size; kept += 1 + size / 200) {
    v1::RenderedItem message = whole;
    message.mutable_planes_zstd()->resize(kept);
    expect_refused(message, "planes_zstd");
  }
}

TEST(TileCodec, NeverTakesDamagedSums) {
  const v1::RenderedItem whole = some_message();
  const core::FilmTile original = *decode_tile(whole);
  const std::size_t bits = whole.planes_zstd().size() * 8;
  for (std::size_t bit = 0; bit < bits; bit += 1 + bits / 2000) {
    v1::RenderedItem message = whole;
    char& byte = (*message.mutable_planes_zstd())[bit / 8];
    byte = static_cast<char>(byte ^ (1 << (bit % 8)));
    // A flipped bit that zstd ignores may pass, but then the sums are unchanged.
    if (const auto tile = decode_tile(message)) {
      EXPECT_EQ(tile->sums, original.sums) << "bit " << bit;
      EXPECT_EQ(tile->odd_sums, original.odd_sums) << "bit " << bit;
    }
  }
}

TEST(TileCodec, RefusesAWrongChecksum) {
  v1::RenderedItem message = some_message();
  message.set_sums_xxh3(message.sums_xxh3() ^ 1);
  expect_refused(message, "sums_xxh3");
}

TEST(TileCodec, RefusesAFrameThatGrowsBeyondItsTile) {
  v1::RenderedItem message = some_message();
  message.set_planes_zstd(zstd_frame(std::string(std::size_t{64} << 20, '\0')));
  ASSERT_LT(message.planes_zstd().size(), 10'000u);
  expect_refused(message, "planes_zstd");
}

TEST(TileCodec, RefusesAFrameOfAnotherTilesSize) {
  v1::RenderedItem message = some_message();
  for (const std::size_t size : {64 * 37 * 48 - 8, 64 * 37 * 48 + 8}) {
    message.set_planes_zstd(zstd_frame(std::string(size, '\0')));
    expect_refused(message, "planes_zstd: its sums are no complete frame of 113664 bytes");
  }
}

TEST(TileCodec, RefusesRectanglesAndRangesThatCannotBe) {
  const auto with = [](auto change) {
    v1::RenderedItem message = some_message();
    change(*message.mutable_item());
    return message;
  };
  expect_refused(with([](auto& item) { item.mutable_rect()->set_x1(64); }), "rect");
  expect_refused(with([](auto& item) { item.mutable_rect()->set_y0(40); }), "rect");
  expect_refused(with([](auto& item) { item.mutable_rect()->set_x1(129); }), "one tile");
  expect_refused(with([](auto& item) { item.mutable_rect()->set_x1(0xffffffff); }), "rect");
  expect_refused(with([](auto& item) { item.clear_rect(); }), "rect");
  expect_refused(with([](auto& item) { item.set_sample_end(3); }), "samples");
  expect_refused(with([](auto& item) { item.set_sample_end(0xffffffff); }), "samples");
}

TEST(TileCodec, RefusesCountersOfOtherSamples) {
  v1::RenderedItem message = some_message();
  message.mutable_counters()->set_samples(64 * 37 * 5 + 1);
  expect_refused(message, "counters.samples");
  message = some_message();
  message.mutable_counters()->set_non_finite_samples(64 * 37 * 5 + 1);
  expect_refused(message, "non-finite");
}

}  // namespace
}  // namespace tessera::proto
