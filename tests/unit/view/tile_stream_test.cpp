// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <half.h>

#include <map>
#include <memory>
#include <utility>

#include "tests/unit/view/view_fixture.hpp"

namespace tessera::view {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::StartsWith;
using State = http::BodySource::State;

constexpr std::size_t kPlenty = 1 << 30;

class TileStreamTest : public testing::Test {
 protected:
  std::unique_ptr<TileStream> open(const StreamQuery& query) {
    return std::make_unique<TileStream>(
        std::shared_ptr<TileSource>(std::shared_ptr<void>(), &growing_.source), query, settings_);
  }

  // What is sent until the stream waits or ends.
  std::vector<Frame> read(TileStream& stream, State* last = nullptr, std::size_t max_bytes = kPlenty) {
    std::string all;
    State state = State::kMore;
    while (state == State::kMore) {
      std::string some;
      state = stream.read(some, max_bytes);
      all += some;
    }
    if (last != nullptr) *last = state;
    return parse_frames(all);
  }

  static bool is_tile(const Frame& frame) { return frame.header.starts_with(R"({"type":"tile)"); }
  static std::size_t count_tiles(const std::vector<Frame>& frames) { return tiles_in(frames).size(); }

  GrowingFilm growing_;
  EncodedTiles tiles_{64 << 20};
  StreamBudget budget_;
  StreamBudget::Clock::time_point now_ = StreamBudget::Clock::time_point{} + std::chrono::hours(1);
  StreamSettings settings_{tiles_, budget_, [this] { return now_; }};
};

TEST_F(TileStreamTest, BeginsWithTheJobAndACoarseImage) {
  growing_.add_to_all(0, 2);
  const auto stream = open({});
  State state = State::kMore;
  const std::vector<Frame> frames = read(*stream, &state);
  EXPECT_EQ(state, State::kWait);
  ASSERT_EQ(frames.size(), 1u + 1 + 9 + 1) << "coarse tiles share a frame";
  EXPECT_EQ(frames[0].header, R"({"type":"job","job":{"name":"job"}})");
  EXPECT_EQ(frames[11].header, R"({"type":"revision","revision":9,"whole":true})");
  // The tile in the middle, and all coarse ones before.
  const std::vector<SentTile> tiles = tiles_in(frames);
  ASSERT_EQ(tiles.size(), 18u);
  for (const std::size_t i : {0, 9}) EXPECT_EQ(tiles[i].rect, (core::PixelRect{71, 75, 135, 139})) << i;
  for (std::size_t i = 0; i < 18; ++i) EXPECT_EQ(tiles[i].level, i < 9 ? 3 : 0);
}

TEST_F(TileStreamTest, CoarseTilesAreMeansOneAfterAnother) {
  growing_.add_to_all(0, 3);
  const auto stream = open({.since = 0, .level = 3});
  std::vector<SentTile> tiles = tiles_in(read(*stream));
  ASSERT_EQ(tiles.size(), 9u) << "without still coarser ones before";
  for (const SentTile& tile : tiles) {
    const int index = growing_.film.grid().tile_at(tile.rect.x0, tile.rect.y0);
    EXPECT_EQ(tile.samples, 3u);
    EXPECT_EQ(tile.revision, static_cast<Revision>(index + 1));
    const core::Image expected = develop_level(tile.rect, growing_.film.tile(index), tile.level);
    EXPECT_EQ(tile.pixels, encode_pixels(expected, PixelFormat::kRawHalf).value());
    const auto decoded = decode_pixels(tile.pixels, expected.width, expected.height, PixelFormat::kRawHalf);
    ASSERT_TRUE(decoded);
    EXPECT_EQ(Imath::half(decoded->at(0, 0).g).bits(), Imath::half(expected.at(0, 0).g).bits());
  }
}

TEST_F(TileStreamTest, HasTheHalvesOfTheFilm) {
  growing_.add_to_all(0, 3);
  const core::Image image = growing_.film.develop();
  const auto stream = open({.since = 0, .level = 0, .region = core::PixelRect{150, 130, 151, 131}});
  const std::vector<Frame> frames = read(*stream);
  ASSERT_EQ(count_tiles(frames), 2u);
  const Frame& tile = frames[2];  // after the coarse one
  EXPECT_THAT(
      tile.header,
      StartsWith(
          R"({"type":"tile","x0":135,"y0":75,"x1":157,"y1":139,"level":0,"revision":6,"samples":3,"noise":0.)"));
  const auto values = halves(tile.payload, 22 * 64 * 3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 22; ++x)
      ASSERT_EQ(values[static_cast<std::size_t>(3 * (22 * y + x) + 2)],
                Imath::half(image.at(135 - 7 + x, 75 - 11 + y).b).bits());
}

TEST_F(TileStreamTest, SendsChangesAsTheyHappen) {
  growing_.add_to_all(0, 1);
  const auto stream = open({.since = 0, .level = 6});
  EXPECT_EQ(count_tiles(read(*stream)), 9u) << "at one level";
  now_ += milliseconds(500);
  EXPECT_EQ(read(*stream).size(), 0u);
  // Many changes of one tile are one update, and no more than ten a second.
  for (std::uint32_t i = 1; i < 6; ++i) growing_.add(3, i, 1);
  now_ += milliseconds(500);
  const std::vector<Frame> frames = read(*stream);
  ASSERT_EQ(frames.size(), 2u);
  ASSERT_EQ(count_tiles(frames), 1u);
  EXPECT_EQ(tiles_in(frames)[0].samples, 6u);
  EXPECT_EQ(frames[1].header, R"({"type":"revision","revision":14,"whole":true})");
  growing_.add(3, 6, 1);
  now_ += milliseconds(60);
  EXPECT_EQ(read(*stream).size(), 0u);
  EXPECT_LE(stream->longest_wait(), milliseconds(60));
  now_ += milliseconds(60);
  EXPECT_EQ(count_tiles(read(*stream)), 1u);
}

TEST_F(TileStreamTest, ResumesAfterARevision) {
  growing_.add_to_all(0, 1);
  growing_.add(2, 1, 1);
  const auto stream = open({.since = 9});
  EXPECT_EQ(read(*stream).size(), 1u) << "the job; updates wait for the budget that viewers share";
  now_ += milliseconds(200);
  const std::vector<Frame> frames = read(*stream);
  ASSERT_EQ(frames.size(), 2u) << "tile, revision";
  EXPECT_THAT(frames[0].header, HasSubstr(R"("level":0,"revision":10,"samples":2)"));
}

TEST_F(TileStreamTest, EndsWithTheJob) {
  growing_.add(0, 0, 1);
  const auto stream = open({});
  State state = State::kMore;
  read(*stream, &state);
  EXPECT_EQ(state, State::kWait);
  growing_.add(1, 0, 1);
  growing_.header_revision = 2;
  growing_.source.end();
  now_ += milliseconds(200);
  const std::vector<Frame> frames = read(*stream, &state);
  EXPECT_EQ(state, State::kEnd);
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_THAT(frames[0].header, HasSubstr(R"("type":"job")"));
  EXPECT_TRUE(is_tile(frames[1]));
  EXPECT_EQ(frames[2].header, R"({"type":"revision","revision":2,"whole":true})");
  EXPECT_EQ(frames[3].header, R"({"type":"end"})");
}

TEST_F(TileStreamTest, KeepsTheConnectionAlive) {
  const auto stream = open({});
  const std::vector<Frame> first = read(*stream);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[1].header, R"({"type":"revision","revision":0,"whole":true})") << "there is nothing";
  now_ += std::chrono::seconds(16);
  const std::vector<Frame> frames = read(*stream);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].header, R"({"type":"keepalive"})");
}

// While the image is written, there is no film to read.
TEST_F(TileStreamTest, WaitsWhileTheFilmIsAway) {
  growing_.add(4, 0, 1);
  growing_.source.detach();
  growing_.source.end();
  const auto stream = open({});
  State state = State::kMore;
  EXPECT_EQ(count_tiles(read(*stream, &state)), 0u);
  EXPECT_EQ(state, State::kWait);
  growing_.source.attach(growing_.film);
  now_ += std::chrono::seconds(1);
  const std::vector<Frame> frames = read(*stream, &state);
  EXPECT_EQ(state, State::kEnd);
  EXPECT_EQ(count_tiles(frames), 1u);
}

// The revision of a stream that is read in small steps grows before all tiles of the start are sent.
TEST_F(TileStreamTest, TellsWhenTheTilesOfTheStartAreSent) {
  growing_.add_to_all(0, 1);
  const auto stream = open({.since = 0, .level = 6});
  std::vector<bool> whole;
  for (std::size_t sent = 0; sent < 9;) {
    std::string some;
    EXPECT_EQ(stream->read(some, 1), State::kMore);
    const std::vector<Frame> frames = parse_frames(some);
    sent += count_tiles(frames);
    growing_.add_to_all(1 + static_cast<std::uint32_t>(sent), 1);
    now_ += milliseconds(1100);
    for (const Frame& frame : frames)
      if (frame.header.starts_with(R"({"type":"revision")")) {
        whole.push_back(frame.header.ends_with(R"("whole":true})"));
        EXPECT_EQ(whole.back(), sent == 9) << frame.header;
      }
  }
  ASSERT_GT(whole.size(), 1u);
  EXPECT_TRUE(whole.back()) << "though tiles that changed since wait";
}

// One that takes little at a time gets every tile's newest samples, once.
TEST_F(TileStreamTest, SendsNoOldStatesToASlowReader) {
  growing_.add_to_all(0, 1);
  const auto stream = open({.since = 0, .level = 6});
  std::vector<SentTile> tiles;
  std::uint32_t next = 1;
  for (int i = 0; i < 9; ++i, ++next) {
    std::string some;
    EXPECT_EQ(stream->read(some, 1), State::kMore);
    growing_.add_to_all(next, 1);
    now_ += milliseconds(60);
    for (SentTile& tile : tiles_in(parse_frames(some))) tiles.push_back(std::move(tile));
  }
  std::map<int, int> counts;
  for (const SentTile& tile : tiles) ++counts[growing_.film.grid().tile_at(tile.rect.x0, tile.rect.y0)];
  for (const auto& [tile, count] : counts) EXPECT_EQ(count, 1) << tile;
  EXPECT_GE(tiles.back().samples, 8u);
}

// However many watch, each revision of a tile is encoded once.
TEST_F(TileStreamTest, SharesItsWork) {
  growing_.add_to_all(0, 1);
  std::vector<std::unique_ptr<TileStream>> streams;
  for (int i = 0; i < 20; ++i) streams.push_back(open({}));
  for (const auto& stream : streams) EXPECT_EQ(count_tiles(read(*stream)), 18u);
  EXPECT_EQ(tiles_.encoded_tiles(), 18u);
}

// What the first image leaves of its allowance is none for updates.
TEST_F(TileStreamTest, SendsUpdatesWithinTheBudgetHoweverSmallTheFirstImageWas) {
  StreamBudget small(200'000, 100'000'000);
  const StreamSettings settings{tiles_, small, [this] { return now_; }};
  growing_.add_to_all(0, 1);
  std::vector<std::unique_ptr<TileStream>> streams;
  for (int i = 0; i < 10; ++i)
    streams.push_back(std::make_unique<TileStream>(
        std::shared_ptr<TileSource>(std::shared_ptr<void>(), &growing_.source), StreamQuery{}, settings));
  const auto send = [&] {
    std::size_t bytes = 0;
    for (const auto& stream : streams)
      for (const Frame& frame : read(*stream)) bytes += frame.payload.size();
    return bytes;
  };
  send();
  std::size_t bytes = 0;
  for (std::uint32_t sample = 1; sample <= 40; ++sample) {
    growing_.add_to_all(sample, 1);
    now_ += milliseconds(200);
    bytes += send();
  }
  EXPECT_LT(static_cast<double>(bytes), 8 * 300'000) << "of 8 seconds";
}

// Beyond the first image, all of them together get what one gets.
TEST_F(TileStreamTest, DividesTheBudget) {
  StreamBudget small(200'000, 100'000);
  const StreamSettings settings{tiles_, small, [this] { return now_; }};
  growing_.add_to_all(0, 1);
  std::vector<std::unique_ptr<TileStream>> streams;
  for (int i = 0; i < 10; ++i)
    streams.push_back(std::make_unique<TileStream>(
        std::shared_ptr<TileSource>(std::shared_ptr<void>(), &growing_.source), StreamQuery{}, settings));
  const auto send = [&] {
    std::size_t bytes = 0;
    for (const auto& stream : streams)
      for (const Frame& frame : read(*stream)) bytes += frame.payload.size();
    return bytes;
  };
  EXPECT_GT(send(), 700'000u) << "the first images";
  std::size_t bytes = 0;
  constexpr std::uint32_t kSteps = 40;
  for (std::uint32_t sample = 1; sample <= kSteps; ++sample) {
    growing_.add_to_all(sample, 1);
    now_ += milliseconds(200);
    bytes += send();
  }
  const double seconds = kSteps * 0.2;
  EXPECT_GT(static_cast<double>(bytes) / seconds, 100'000);
  EXPECT_LT(static_cast<double>(bytes) / seconds, 300'000);
}

}  // namespace
}  // namespace tessera::view
