// Tiles as the store keeps them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include "proto/tile_codec.hpp"
#include "server/coordinator/job_film.hpp"
#include "server/coordinator/tile_planes.hpp"

namespace tessera::coordinator {
namespace {

using core::ErrorCode;

const core::PixelRect kRect{64, 128, 69, 131};  // 45 sums: no multiple of sixteen
const std::vector<core::SampleRange> kDone{{0, 3}, {8, 12}};

// Every byte of the sums is needed.
TileContent content() {
  TileContent tile;
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

TEST(TileRow, GivesBackWhatWasPutIn) {
  const store::TileRow row = encode_tile_row("job", 5, kRect, kDone, content());
  EXPECT_EQ(row.done, kDone);
  const auto read = decode_tile_row(row, kRect);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sums, content().sums);
  EXPECT_EQ(read->counters, content().counters);
}

TEST(TileRow, ReadsWhatEarlierReleasesWrote) {
  const TileContent tile = content();
  core::FilmTile item(kRect, {0, 7});
  item.sums = tile.sums.sums;
  item.odd_sums = tile.sums.odd_sums;
  item.counters = tile.counters;
  const auto read = decode_tile_row({"job", 5, kDone, proto::encode_tile(item).SerializeAsString()}, kRect);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sums, tile.sums);
}

TEST(TileRow, RefusesWhatIsNotOfTheTile) {
  const store::TileRow row = encode_tile_row("job", 5, kRect, kDone, content());
  const auto code_of = [](const core::Result<TileContent>& read) {
    return read ? std::nullopt : std::optional(read.error().code);
  };
  store::TileRow more = row;
  more.done.push_back({20, 21});
  EXPECT_EQ(code_of(decode_tile_row(more, kRect)), ErrorCode::kDataLoss);
  EXPECT_EQ(code_of(decode_tile_row(row, {0, 0, 5, 3})), ErrorCode::kDataLoss);
  EXPECT_EQ(code_of(decode_tile_row(row, {64, 128, 70, 131})), ErrorCode::kDataLoss);
  for (std::size_t size = 0; size < row.content.size(); ++size) {
    store::TileRow cut = row;
    cut.content.resize(size);
    EXPECT_EQ(code_of(decode_tile_row(cut, kRect)), ErrorCode::kDataLoss) << size;
  }
}

// What is stored must still be read by later releases: it is not enough that decoding undoes encoding.
TEST(TilePlanes, HoldTheLowestBytesFirst) {
  constexpr std::size_t kCount = 45;
  std::vector<std::uint64_t> sums(kCount), odd_sums(kCount);
  std::string expected(16 * kCount, '\0');
  for (std::size_t i = 0; i < 2 * kCount; ++i) {
    std::uint64_t& sum = i < kCount ? sums[i] : odd_sums[i - kCount];
    for (std::size_t plane = 0; plane < 8; ++plane) {
      const std::uint64_t byte = (i * 31 + plane * 7 + 1) & 0xff;
      sum |= byte << (8 * plane);
      expected[plane * 2 * kCount + i] = static_cast<char>(byte);
    }
  }
  const std::string frame = encode_planes(sums, odd_sums);
  std::string planes(expected.size(), '\0');
  ASSERT_EQ(ZSTD_decompress(planes.data(), planes.size(), frame.data(), frame.size()), planes.size());
  EXPECT_EQ(planes, expected);
}

TEST(TilePlanes, AreSmallWhereHighBytesAreAlike) {
  std::vector<std::uint64_t> sums(12288), odd_sums(12288);
  std::uint64_t state = 1;
  for (std::uint64_t& sum : sums) {
    state = state * 6364136223846793005 + 1442695040888963407;
    sum = state >> 40;  // three bytes of noise under five of zeros
  }
  EXPECT_LT(encode_planes(sums, odd_sums).size(), 12288 * 3 + 500);
}

}  // namespace
}  // namespace tessera::coordinator
