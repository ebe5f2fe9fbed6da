// SPDX-License-Identifier: Apache-2.0
// Watchers of an image get every tile's last samples, exactly, once for each change.
#include "server/watch/tile_feed.hpp"

#include <gmock/gmock.h>
#include <libdeflate.h>

#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "proto/convert.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kPlenty = 1 << 30;

template <typename Number>
std::vector<Number> inflate(const std::string& bytes, std::size_t count) {
  std::vector<Number> numbers(count);
  libdeflate_decompressor* const inflater = libdeflate_alloc_decompressor();
  std::size_t size = 0;
  EXPECT_EQ(libdeflate_zlib_decompress(inflater, bytes.data(), bytes.size(), numbers.data(),
                                       count * sizeof(Number), &size),
            LIBDEFLATE_SUCCESS);
  EXPECT_EQ(size, count * sizeof(Number));
  libdeflate_free_decompressor(inflater);
  return numbers;
}

// What a viewer has of an image.
class View {
 public:
  void draw(const v1::TileImage& tile) {
    const core::PixelRect rect = *proto::from_proto(tile.rect());
    const auto floats = inflate<float>(tile.pixels_zlib(), 3 * rect.pixel_count());
    auto value = floats.begin();
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x)
        for (float core::Rgb::*channel : {&core::Rgb::r, &core::Rgb::g, &core::Rgb::b})
          image_.at(x, y).*channel = *value++;
  }
  const std::vector<core::Rgb>& pixels() const { return image_.pixels; }
  bool shows(const core::Image& image) const { return image_.pixels == image.pixels; }

 private:
  core::Image image_{kWidthPx, kHeightPx};
};

class TileFeed : public ScriptedFarm {
 protected:
  watch::TileUpdate update(const std::string& job, events::Revision since = 0,
                           std::size_t max_bytes = kPlenty) {
    const auto updated =
        coordinator().tile_feed().update({job, since, v1::TILE_FORMAT_RGB32F, {}, max_bytes});
    EXPECT_TRUE(updated) << updated.error().message;
    return updated ? *updated : watch::TileUpdate();
  }
  static View view_of(const watch::TileUpdate& update) {
    View view;
    for (const v1::TileImage& tile : update.tiles) view.draw(tile);
    return view;
  }
  core::Image image_of(const std::string& job) { return coordinator().images().get(job)->image; }
  core::Status refusal(watch::TileQuery query) {
    const auto updated = coordinator().tile_feed().update(query);
    return updated ? core::Status() : core::fail(updated.error());
  }
};

TEST_F(TileFeed, HasTheImageToTheBit) {
  const std::string id = submit();
  EXPECT_THAT(update(id).tiles, IsEmpty()) << "there are no samples yet";
  work('a', 2);
  EXPECT_TRUE(view_of(update(id)).shows(image_of(id)));
  work('a');
  const watch::TileUpdate done = update(id);
  EXPECT_EQ(done.tiles.size(), 6u);
  EXPECT_TRUE(done.is_current);
  EXPECT_TRUE(view_of(done).shows(ready_made_image(kWidthPx, kHeightPx, kSpp)));
  for (const v1::TileImage& tile : done.tiles) {
    EXPECT_EQ(tile.samples(), kSpp);
    EXPECT_EQ(tile.samples_target(), kSpp);
  }
}

TEST_F(TileFeed, HasWhatChangedSince) {
  const std::string id = submit();
  work('a', 1);
  View view;
  watch::TileUpdate last = update(id);
  for (int leases = 0; leases < 100 && !last.tiles.empty(); ++leases) {
    for (const v1::TileImage& tile : last.tiles) view.draw(tile);
    EXPECT_TRUE(view.shows(image_of(id)));
    EXPECT_THAT(update(id, last.revision).tiles, IsEmpty());
    work('a', 1);
    last = update(id, last.revision);
  }
  EXPECT_TRUE(view.shows(ready_made_image(kWidthPx, kHeightPx, kSpp)));
}

// A part at a time, while the tiles change.
TEST_F(TileFeed, HidesNoTileFromASlowWatcher) {
  const std::string id = submit();
  work('a', 1);
  View view;
  events::Revision since = 0;
  for (int parts = 0; parts < 1000; ++parts) {
    const watch::TileUpdate part = update(id, since, 1);
    EXPECT_LE(part.tiles.size(), 1u);
    if (part.is_current && part.tiles.empty() && part.job.samples_done() == kSamples) break;
    for (const v1::TileImage& tile : part.tiles) view.draw(tile);
    since = part.revision;
    if (parts % 3 == 2) work('a', 1);
  }
  EXPECT_TRUE(view.shows(ready_made_image(kWidthPx, kHeightPx, kSpp)));
}

TEST_F(TileFeed, GoesOnAfterARestart) {
  const std::string id = submit();
  work('a', 2);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  const watch::TileUpdate before = update(id);
  View view = view_of(before);
  open();
  EXPECT_TRUE(view_of(update(id)).pixels() == view.pixels());
  EXPECT_THAT(update(id, before.revision).tiles, IsEmpty()) << "nothing has changed";
  work('a');
  for (const v1::TileImage& tile : update(id, before.revision).tiles) view.draw(tile);
  EXPECT_TRUE(view.shows(ready_made_image(kWidthPx, kHeightPx, kSpp)));
}

// The film is in the store alone then.
TEST_F(TileFeed, HasTheTilesOfAStoredJob) {
  const std::string id = submit();
  work('a');
  const watch::TileUpdate running = update(id);
  ASSERT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  for (int starts = 0; starts < 2; ++starts) {
    EXPECT_THAT(update(id, running.revision).tiles, IsEmpty());
    EXPECT_TRUE(view_of(update(id)).shows(ready_made_image(kWidthPx, kHeightPx, kSpp)));
    open();
  }
}

// What a crash has cost is rendered again, and sent again.
TEST_F(TileFeed, HasNoTilesOfAJobThatIsNotValidated) {
  v1::SubmitJobRequest request = submission();
  request.mutable_overrides()->set_width_px(20);
  const auto submitted = coordinator().jobs().submit(request);
  ASSERT_TRUE(submitted);
  for (const v1::JobState state : {v1::JOB_STATE_VALIDATING, v1::JOB_STATE_CANCELLED}) {
    const watch::TileUpdate before = update(submitted->id());
    EXPECT_EQ(before.job.state(), state);
    EXPECT_THAT(before.tiles, IsEmpty());
    EXPECT_TRUE(before.is_current);
    ASSERT_TRUE(coordinator().jobs().cancel(submitted->id()));
    ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  }
}

TEST_F(TileFeed, SendsAgainWhatARestartHasLost) {
  const std::string id = submit();
  const std::uint64_t none = update(id).revision;
  work('a', 1);
  const watch::TileUpdate lost = update(id);
  ASSERT_FALSE(lost.tiles.empty());
  std::filesystem::copy(folder_.path() / "state", folder_.path() / "crashed",
                        std::filesystem::copy_options::recursive);
  open(folder_.path() / "crashed");
  EXPECT_THAT(update(id, none).tiles, IsEmpty());
  work('a');
  EXPECT_TRUE(view_of(update(id, lost.revision)).shows(ready_made_image(kWidthPx, kHeightPx, kSpp)));
}

TEST_F(TileFeed, EncodesEachRevisionOnceForAll) {
  const std::string id = submit();
  work('a');
  std::vector<std::thread> watchers;
  for (int i = 0; i < 8; ++i) watchers.emplace_back([&] { EXPECT_EQ(update(id).tiles.size(), 6u); });
  for (std::thread& watcher : watchers) watcher.join();
  EXPECT_EQ(coordinator().tile_feed().images().encoded_tiles(), 6u);
  ASSERT_TRUE(coordinator().tile_feed().update({id, 0, v1::TILE_FORMAT_RGB16F, {}, kPlenty}));
  EXPECT_EQ(coordinator().tile_feed().images().encoded_tiles(), 12u) << "the other format";
}

TEST_F(TileFeed, HasOnlyTheTilesOfARegion) {
  const std::string id = submit();
  work('a');
  const auto part = coordinator().tile_feed().update(
      {id, 0, v1::TILE_FORMAT_RGB32F, core::PixelRect{63, 10, 65, 11}, kPlenty});
  ASSERT_TRUE(part);
  std::set<std::uint32_t> columns;
  for (const v1::TileImage& tile : part->tiles) {
    EXPECT_EQ(tile.rect().y0(), 0u);
    columns.insert(tile.rect().x0());
  }
  EXPECT_THAT(columns, testing::ElementsAre(0u, 64u));
  EXPECT_EQ(part->revision, update(id).revision) << "the others are no news either";
}

TEST_F(TileFeed, RefusesWhatItDoesNotHave) {
  const std::string id = submit();
  const core::Status unknown = refusal({id, 0, v1::TILE_FORMAT_UNSPECIFIED, {}, kPlenty});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, core::ErrorCode::kInvalidArgument);
  const core::Status outside =
      refusal({id, 0, v1::TILE_FORMAT_RGB16F, core::PixelRect{0, 0, kWidthPx + 1, 1}, kPlenty});
  ASSERT_FALSE(outside);
  EXPECT_THAT(outside.error().message, HasSubstr("region"));
  const core::Status nothing = refusal({"nothing", 0, v1::TILE_FORMAT_RGB16F, {}, kPlenty});
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, core::ErrorCode::kNotFound);
}

}  // namespace
}  // namespace tessera::server
