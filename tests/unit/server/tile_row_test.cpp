// SPDX-License-Identifier: Apache-2.0
// Tiles as stored.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <optional>

#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "proto/tile_planes.hpp"
#include "server/film/tile_row.hpp"
#include "tests/support/layered_tile.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;

const core::PixelRect kRect{64, 128, 69, 131};  // 45 sums: no multiple of sixteen
const std::vector<core::SampleRange> kDone{{0, 3}, {8, 12}};

// Sums that use all their bytes.
film::TileContent content() {
  film::TileContent tile;
  for (std::uint64_t i = 0; i < kRect.pixel_count() * 3; ++i) {
    tile.sums.sums.push_back(0x0123456789abcdef * (i + 1));
    tile.sums.odd_sums.push_back(i == 7 ? core::kFilmSaturated : i << (i % 60));
  }
  tile.sums.samples = 7;
  tile.sums.odd_samples = 3;
  tile.counters.samples = 7 * kRect.pixel_count();
  tile.counters.closest_hit_rays = 99;
  tile.counters.first_non_finite = core::SampleId{65, 129, 2};
  return tile;
}

std::optional<ErrorCode> code_of(const core::Result<film::TileContent>& read) {
  return read ? std::nullopt : std::optional(read.error().code);
}

std::string frame_of_sums_in_a_row(const film::TileContent& tile) {
  std::vector<std::uint64_t> raw = tile.sums.sums;
  raw.insert(raw.end(), tile.sums.odd_sums.begin(), tile.sums.odd_sums.end());
  const std::size_t size = raw.size() * sizeof(std::uint64_t);
  std::string frame(ZSTD_compressBound(size), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), raw.data(), size, 1));
  return frame;
}

TEST(TileRow, GivesBackWhatWasPutIn) {
  const store::TileRow row = film::encode_tile_row("job", 5, kRect, kDone, content());
  EXPECT_EQ(row.done, kDone);
  const auto read = film::decode_tile_row(row, kRect);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sums, content().sums);
  EXPECT_EQ(read->counters, content().counters);
}

TEST(TileRow, HasThePlanesOfLayers) {
  core::FilmTile samples(kRect, {0, 7}, core::kAllLayers);
  test::add_made_up_planes(samples);
  film::TileContent tile = content();
  tile.sums.planes = samples.planes;
  const store::TileRow row = film::encode_tile_row("job", 5, kRect, kDone, tile);
  const auto read = film::decode_tile_row(row, kRect, core::kAllLayers);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sums, tile.sums);
  EXPECT_EQ(code_of(film::decode_tile_row(row, kRect)), ErrorCode::kDataLoss);
  const store::TileRow without = film::encode_tile_row("job", 5, kRect, kDone, content());
  EXPECT_EQ(code_of(film::decode_tile_row(without, kRect, core::kAllLayers)), ErrorCode::kDataLoss);
  tile.sums.planes[0] = {1, 2, 3};
  EXPECT_EQ(code_of(film::decode_tile_row(film::encode_tile_row("job", 5, kRect, kDone, tile), kRect,
                                          core::kAllLayers)),
            ErrorCode::kDataLoss);
}

TEST(TileRow, ReadsWhatEarlierReleasesWrote) {
  const film::TileContent tile = content();
  core::FilmTile item(kRect, {0, 7});
  item.sums = tile.sums.sums;
  item.odd_sums = tile.sums.odd_sums;
  item.counters = tile.counters;
  v1::RenderedItem message = proto::encode_tile(item);
  message.clear_planes_zstd();
  message.set_sums_zstd(frame_of_sums_in_a_row(tile));
  const auto read = film::decode_tile_row({"job", 5, kDone, message.SerializeAsString()}, kRect);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sums, tile.sums);
}

// As release 0.2.0 wrote it, with the provenance behind the message.
TEST(TileRow, ReadsPlanesOfEarlierReleasesWithTheirProvenance) {
  const film::TileContent tile = content();
  v1::RenderedItem message;
  *message.mutable_item() = proto::to_proto(proto::WorkItem{kRect, {0, 7}});
  message.set_sums_zstd(proto::encode_planes(tile.sums.sums, tile.sums.odd_sums));
  *message.mutable_counters() = proto::to_proto(tile.counters);
  const film::Produced provenance{
      9, {{{5, {0, 3}}, {"name", {"worker"}, "machine"}, {1, 2, 3}, scheduler::Due::kNo}}};
  const std::string bytes =
      "P" + message.SerializeAsString() + film::to_stored(provenance).SerializeAsString();
  const auto read = film::decode_tile_row({"job", 5, kDone, bytes}, kRect);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sums, tile.sums);
  EXPECT_EQ(read->counters, tile.counters);
  EXPECT_EQ(read->provenance.fingerprinter, 9u);
  EXPECT_EQ(read->provenance.items, provenance.items);
}

// Its samples were wrong, and no others have arrived since.
TEST(TileRow, CanBeOfNoSamplesAtAll) {
  const auto read = film::decode_tile_row(film::encode_tile_row("job", 5, kRect, {}, {}), kRect);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sums, core::Film::TileSums{});
  EXPECT_EQ(read->counters, core::RenderCounters{});
}

TEST(TileRow, RefusesWhatIsNotOfTheTile) {
  const store::TileRow row = film::encode_tile_row("job", 5, kRect, kDone, content());
  store::TileRow more = row;
  more.done.push_back({20, 21});
  EXPECT_EQ(code_of(film::decode_tile_row(more, kRect)), ErrorCode::kDataLoss);
  EXPECT_EQ(code_of(film::decode_tile_row(row, {0, 0, 5, 3})), ErrorCode::kDataLoss);
  EXPECT_EQ(code_of(film::decode_tile_row(row, {64, 128, 70, 131})), ErrorCode::kDataLoss);
  for (std::size_t size = 0; size < row.content.size(); ++size) {
    store::TileRow cut = row;
    cut.content.resize(size);
    EXPECT_EQ(code_of(film::decode_tile_row(cut, kRect)), ErrorCode::kDataLoss) << size;
  }
}

}  // namespace
}  // namespace tessera::server
