// SPDX-License-Identifier: Apache-2.0
#include "client/render_checkpoint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/base/version.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::client {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr core::PixelRect kWindow{10, 20, 160, 90};

core::RenderSettings small_settings() {
  return {.width_px = 200, .height_px = 100, .spp = 8, .crop = kWindow};
}

core::FilmTile tile_of(core::PixelRect rect, core::SampleRange range, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  core::FilmTile tile(rect, range);
  for (std::uint64_t& sum : tile.sums) sum = random() >> (8 + seed % 40);
  for (std::uint64_t& sum : tile.odd_sums) sum = random() >> (8 + seed % 40);
  tile.counters.samples = rect.pixel_count() * range.count();
  tile.counters.shadow_rays = 7;
  return tile;
}

class RenderCheckpoint : public testing::Test {
 protected:
  RenderCheckpoint()
      : film_(core::TileGrid(kWindow, core::kTilePx)), path_(folder_.path() / "a.png.tessera") {
    // Tiles with different numbers of samples, one that is black, one without any.
    const core::TileGrid& grid = film_.grid();
    for (int tile = 0; tile < grid.tile_count() - 2; ++tile) {
      const auto samples = 1 + static_cast<std::uint32_t>(tile) % 5;
      const core::FilmTile added = tile_of(grid.rect(tile), {0, samples}, static_cast<std::uint64_t>(tile));
      film_.add(added, {added.counters, 0.5, 1.5}, {});
    }
    core::FilmTile black(grid.rect(grid.tile_count() - 2), {0, 3});
    black.counters.samples = black.rect.pixel_count() * 3;
    black.counters.first_non_finite = core::SampleId{11, 22, 1};
    film_.add(black, {black.counters, 0, 0}, {});
    EXPECT_TRUE(write_checkpoint(path_, identity_, film_));
  }

  std::string refusal(const RenderIdentity& render) const {
    const auto read = read_checkpoint(path_, render);
    return read ? "" : read.error().message;
  }

  const TemporaryFolder folder_;
  const RenderIdentity identity_ = identity_of(small_settings(), core::digest_of(test::room()));
  SharedFilm film_;
  const std::string path_;
};

TEST_F(RenderCheckpoint, HoldsTheExactFilmAndTheTotals) {
  const auto read = read_checkpoint(path_, identity_);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->film == film_.film());
  const RenderTotals totals = film_.totals();
  EXPECT_EQ(read->header.totals.counters, totals.counters);
  EXPECT_EQ(read->header.totals.seconds, totals.seconds);
  EXPECT_EQ(read->header.totals.core_seconds, totals.core_seconds);
  const auto header = read_checkpoint_header(path_);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->totals.counters, totals.counters);
  EXPECT_EQ(difference(header->render, identity_), "");
}

TEST_F(RenderCheckpoint, LeavesNothingElseBehind) {
  write_file(path_ + ".partial", "of a run that was killed");
  ASSERT_TRUE(write_checkpoint(path_, identity_, film_));
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    files += entry.exists() ? 1 : 0;
  EXPECT_EQ(files, 1u);
}

TEST_F(RenderCheckpoint, MoreSamplesAreWelcomeAndFewerAreNot) {
  RenderIdentity more = identity_, fewer = identity_;
  more.settings.spp = 1000;
  EXPECT_EQ(refusal(more), "");
  fewer.settings.spp = 3;
  EXPECT_THAT(refusal(fewer), HasSubstr("has 4 samples per pixel already: give a larger --spp than 3"));
}

TEST_F(RenderCheckpoint, OfAnotherRenderIsRefusedWithWhatDiffers) {
  const std::vector<std::pair<std::function<void(RenderIdentity&)>, const char*>> changes{
      {[](auto& r) { r.settings.width_px = 300; }, "its size is 200x100, and not 300x100"},
      {[](auto& r) { r.settings.crop.reset(); }, "its crop is 10,20,160,90, and not the whole image"},
      {[](auto& r) { r.settings.seed = 5; }, "its seed is 0, and not 5"},
      {[](auto& r) { r.settings.integrator = core::Integrator::kNee; }, "its integrator is mis, and not nee"},
      {[](auto& r) { r.settings.heuristic = core::Heuristic::kPower; },
       "its heuristic is balance, and not power"},
      {[](auto& r) { r.settings.max_depth = 4; }, "its max_depth is 0, and not 4"},
      {[](auto& r) { r.settings.clamp_indirect = 2; }, "its clamp_indirect is 0, and not 2"},
      {[](auto& r) { r.settings.filter.radius_px = 2; }, "its filter is box with a radius of 0.5 pixels"},
      {[](auto& r) { r.settings.layers = core::kAllLayers; }, "its set of layers is none, and not all"},
      {[](auto& r) { r.scene.camera.low ^= 1; }, "the camera of the scene differs"},
      {[](auto& r) { r.scene.shapes.low ^= 1; }, "the shapes of the scene differ"},
      {[](auto& r) { r.scene.environment.high ^= 1; }, "the environment of the scene differs"},
      {[](auto& r) { r.determinism_fingerprint = "0"; }, "whose images are not bit-compatible with those of"},
  };
  for (const auto& [change, sentence] : changes) {
    RenderIdentity other = identity_;
    change(other);
    const auto read = read_checkpoint(path_, other);
    ASSERT_FALSE(read) << sentence;
    EXPECT_EQ(read.error().code, core::ErrorCode::kFailedPrecondition);
    EXPECT_THAT(read.error().message, StartsWith("'" + path_ + "' belongs to another render: "));
    EXPECT_THAT(read.error().message, HasSubstr(sentence));
  }
}

TEST_F(RenderCheckpoint, DamagedFilesAreRefused) {
  const std::string whole = read_file(path_);
  std::mt19937_64 random(1);
  for (int i = 0; i < 600; ++i) {
    std::string bytes = whole;
    const std::size_t at = i < 200 ? static_cast<std::size_t>(i) : random() % bytes.size();
    if (i % 3 == 2) bytes.resize(at);
    if (i % 3 != 2) bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    write_file(path_, bytes);
    const auto read = read_checkpoint(path_, identity_);
    ASSERT_FALSE(read) << i;
    EXPECT_EQ(read.error().code, core::ErrorCode::kDataLoss);
  }
  for (const char* other : {"", "x", "{\"camera\": {}}"}) {
    write_file(path_, other);
    EXPECT_THAT(refusal(identity_), HasSubstr("it is no checkpoint that this release can continue"));
    EXPECT_FALSE(read_checkpoint_header(path_));
  }
}

TEST_F(RenderCheckpoint, MissingFilesAreRefused) {
  std::filesystem::remove(path_);
  const auto read = read_checkpoint(path_, identity_);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, core::ErrorCode::kNotFound);
  EXPECT_EQ(read.error().message, "there is no checkpoint '" + path_ + "'");
}

TEST_F(RenderCheckpoint, ThatCannotBeWrittenSaysWhy) {
  const auto written = write_checkpoint((folder_.path() / "missing" / "file").string(), identity_, film_);
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("cannot write '"));
}

// Equal scenes have equal digests, and each part has its own.
TEST(SceneDigest, TellsThePartsApart) {
  const core::SceneDescription room = test::room();
  const core::SceneDigest digest = core::digest_of(room);
  EXPECT_EQ(core::digest_of(test::room()), digest);
  core::SceneDescription other = room;
  other.settings.spp = 1000;
  other.display.exposure_stops = 2;
  other.warnings.push_back("w");
  EXPECT_EQ(core::digest_of(other), digest);
  other.camera.position.x += 1e-6f;
  other.materials.front().two_sided_emission ^= true;
  const core::SceneDigest changed = core::digest_of(other);
  EXPECT_NE(changed.camera, digest.camera);
  EXPECT_NE(changed.materials, digest.materials);
  EXPECT_EQ(changed.shapes, digest.shapes);
  EXPECT_EQ(changed.textures, digest.textures);
  EXPECT_EQ(changed.environment, digest.environment);
  other = room;
  other.shape_names.resize(room.shapes.size());
  other.shape_names.front() += "ball";  // Cryptomatte layers hold it
  EXPECT_NE(core::digest_of(other).shapes, digest.shapes);
}

// The snapshot is of its moment, whatever is added before it is taken.
TEST(SharedFilmSnapshot, IsOfOneMoment) {
  const core::TileGrid grid(kWindow, core::kTilePx);
  SharedFilm film(grid);
  const auto add = [&](const core::PixelRect& rect, core::SampleRange range) {
    const core::FilmTile tile = tile_of(rect, range, 3);
    film.add(tile, {tile.counters, 1, 1}, {});
  };
  add(kWindow, {0, 1});
  const core::Film before = film.film();
  const RenderTotals totals = film.totals();
  {
    SharedFilm::Snapshot snapshot(film);
    EXPECT_EQ(snapshot.take(0), before.tile(0));
    add(kWindow, {1, 2});
    add(grid.rect(1), {2, 3});
    EXPECT_EQ(snapshot.totals().counters, totals.counters);
    for (int tile = 1; tile < grid.tile_count(); ++tile) EXPECT_EQ(snapshot.take(tile), before.tile(tile));
  }
  SharedFilm::Snapshot next(film);
  for (int tile = 0; tile < grid.tile_count(); ++tile) EXPECT_EQ(next.take(tile), film.tile(tile));
}

}  // namespace
}  // namespace tessera::client
