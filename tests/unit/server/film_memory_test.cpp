// SPDX-License-Identifier: Apache-2.0
// Films in less memory than their samples take.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <atomic>
#include <filesystem>
#include <thread>
#include <vector>

#include "proto/tile_codec.hpp"
#include "server/film/job_film.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

constexpr double kGib = 1 << 30;
// The sums of one tile of these images, 64 x 64 pixels, while they fit in 32 bits.
constexpr double kTileBytes = 2 * 64 * 64 * 3 * 4;

// A farm whose films have memory for about two tiles of six.
class FilmMemory : public ScriptedFarm {
 protected:
  FilmMemory() {
    limits_.film_gib = 2.2 * kTileBytes / kGib;
    open();
  }

  // Delivers one lease, after checkpoints that make room for it. Returns false if there is none.
  bool deliver_next(core::Film& expected) {
    const WaitingCall call(coordinator(), greeting('a'));
    if (!call.answered() || call.answer()->leases().empty()) return false;
    for (const v1::Lease& lease : call.answer()->leases()) {
      for (const v1::WorkItem& each : lease.items()) deliver_item(lease, each, expected);
      v1::SubmitResultRequest rest = delivery('a', lease);
      rest.clear_items();
      deliver(rest);
    }
    return true;
  }

  void deliver_item(const v1::Lease& lease, const v1::WorkItem& item, core::Film& expected) {
    v1::SubmitResultRequest request = delivery('a', lease);
    request.clear_items();
    request.set_lease_finished(false);
    *request.add_items() = ready_made_item(item);
    auto counted = coordinator().dispatcher().submit_result(request);
    while (!counted) {
      ASSERT_EQ(counted.error().code, ErrorCode::kUnavailable) << counted.error().message;
      ++refused_;
      ASSERT_TRUE(coordinator().checkpointer().checkpoint());
      counted = coordinator().dispatcher().submit_result(request);
    }
    ASSERT_EQ(counted->accepted_items(), 1u);
    const auto samples = proto::decode_tile(request.items(0));
    expected.add(*samples);
    last_tile_ = expected.grid().tile_at(samples->rect.x0, samples->rect.y0);
  }

  void execute(const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((folder_.path() / "state" / "tessera.db").c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }

  std::vector<core::Rgb> pixels(const std::string& id) {
    const auto found = coordinator().images().get(id);
    EXPECT_TRUE(found) << found.error().message;
    return found ? found->image.pixels : std::vector<core::Rgb>();
  }

  int refused_ = 0;
  int last_tile_ = 0;  // of the latest delivery
};

core::Film empty_film() {
  return core::Film(core::TileGrid(kWidthPx, kHeightPx, core::kTilePx));
}

TEST_F(FilmMemory, ImagesAreTheSameBytesAtAnyMoment) {
  const std::string id = submit();
  core::Film expected = empty_film();
  for (int lease = 0; deliver_next(expected); ++lease) {
    if (lease % 3 == 0) ASSERT_TRUE(coordinator().checkpointer().checkpoint());
    ASSERT_EQ(pixels(id), expected.develop().pixels) << "lease " << lease;
  }
  EXPECT_GT(refused_, 0) << "the film fits into memory, and the test shows nothing";
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(pixels(id), ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

// Such as while the disk is full.
TEST_F(FilmMemory, WorkersKeepTheirLeasesHoweverLongResultsHaveToWait) {
  const std::string id = submit();
  v1::Lease lease;
  const auto deliver_it = [&] { return coordinator().dispatcher().submit_result(delivery('a', lease)); };
  do {
    const v1::SynchronizeResponse answer = synchronize(greeting('a'));
    ASSERT_EQ(answer.leases_size(), 1);
    lease = answer.leases(0);
  } while (deliver_it());
  v1::SynchronizeRequest heartbeat = greeting('a');
  *heartbeat.add_held() = lease;
  heartbeat.add_known_job_ids(lease.job_id());
  for (int i = 0; i < 100; ++i) {
    now_ += std::chrono::seconds(5);
    const WaitingCall call(coordinator(), heartbeat);
    ASSERT_FALSE(call.answered()) << "its lease was taken away after " << 5 * i << " s";
    ASSERT_EQ(deliver_it().error().code, ErrorCode::kUnavailable);
  }
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  EXPECT_EQ(job(id).active_workers(), 1u);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  const auto counted = deliver_it();
  ASSERT_TRUE(counted) << counted.error().message;
  EXPECT_EQ(counted->accepted_items(), static_cast<std::uint32_t>(lease.items_size()));
  core::Film unused = empty_film();
  while (deliver_next(unused)) {
  }
  EXPECT_EQ(pixels(id), ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(FilmMemory, IsGivenBackWhenJobsEnd) {
  for (int i = 0; i < 3; ++i) {
    const std::string id = submit();
    core::Film expected = empty_film();
    while (deliver_next(expected)) {
    }
    EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  }
  const std::string id = submit();
  core::Film expected = empty_film();
  refused_ = 0;
  ASSERT_TRUE(deliver_next(expected));
  EXPECT_EQ(refused_, 0);
}

TEST_F(FilmMemory, ARestartContinuesWhatDoesNotFitIntoMemory) {
  const std::string id = submit();
  core::Film expected = empty_film();
  for (int lease = 0; lease < 9; ++lease) ASSERT_TRUE(deliver_next(expected));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  EXPECT_EQ(pixels(id), expected.develop().pixels);
  while (deliver_next(expected)) {
  }
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(pixels(id), ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(FilmMemory, ADoneJobIsExtendedWithoutItsFilmInMemory) {
  const std::string id = submit();
  core::Film expected = empty_film();
  while (deliver_next(expected)) {
  }
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  ASSERT_TRUE(coordinator().jobs().extend(id, 2 * kSpp));
  EXPECT_EQ(pixels(id), expected.develop().pixels);
  while (deliver_next(expected)) {
  }
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(pixels(id), ready_made_image(kWidthPx, kHeightPx, 2 * kSpp).pixels);
}

// What can be refused without its film does not load it: a tile of it is damaged.
TEST_F(FilmMemory, ADoneJobIsReadOnlyIfItMayBeExtended) {
  limits_.film_gib = 1;
  limits_.spp = 2 * kSpp;
  limits_.open_jobs = 1;
  open();
  const std::string id = submit();
  work('a');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  execute("UPDATE tiles SET content = X'00'");
  const auto refusal_of = [&](std::uint32_t spp) { return coordinator().jobs().extend(id, spp).error(); };
  EXPECT_THAT(refusal_of(2 * kSpp + 1).message, HasSubstr("--max-spp"));
  EXPECT_EQ(refusal_of(1).code, ErrorCode::kInvalidArgument);
  const std::string other = submit();
  EXPECT_THAT(refusal_of(2 * kSpp).message, HasSubstr("--max-open-jobs"));
  ASSERT_TRUE(coordinator().jobs().cancel(other));
  EXPECT_EQ(refusal_of(2 * kSpp).code, ErrorCode::kDataLoss) << "it may, and is read";
  fingerprints_ = {"beef"};
  open();
  EXPECT_THAT(refusal_of(2 * kSpp).message, HasSubstr("by workers of another build"));
}

TEST_F(FilmMemory, ATileThatTheStoreHasLostIsRenderedAgain) {
  const std::string id = submit();
  core::Film expected = empty_film();
  ASSERT_TRUE(deliver_next(expected));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  execute("UPDATE tiles SET content = X'00'");
  while (deliver_next(expected)) ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(pixels(id), ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(FilmMemory, ACancelledJobKeepsWhatTheStoreHasNotLost) {
  const std::string id = submit();
  core::Film expected = empty_film();
  ASSERT_TRUE(deliver_next(expected));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  ASSERT_TRUE(deliver_next(expected));
  execute("UPDATE tiles SET content = X'00' WHERE tile = " + std::to_string(last_tile_));
  ASSERT_TRUE(coordinator().jobs().cancel(id));
  // The first one finds the damage, and the next one stores what is left.
  EXPECT_TRUE(coordinator().checkpointer().checkpoint());
  EXPECT_TRUE(coordinator().checkpointer().checkpoint());
  EXPECT_TRUE(coordinator().images().get(id));
  open();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_CANCELLED);
  EXPECT_TRUE(coordinator().images().get(id));
}

TEST_F(FilmMemory, AJobThatIsDeletedWithTilesToStoreDisturbsNoCheckpoint) {
  const std::string id = submit(), other = submit();
  core::Film expected = empty_film();
  ASSERT_TRUE(deliver_next(expected));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  ASSERT_TRUE(coordinator().jobs().remove(id));
  ASSERT_TRUE(coordinator().jobs().remove_deleted_tiles());
  EXPECT_TRUE(coordinator().checkpointer().checkpoint());
  core::Film of_other = empty_film();
  while (deliver_next(of_other)) ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  EXPECT_EQ(stored_job(other).state(), v1::JOB_STATE_DONE);
}

TEST_F(FilmMemory, ACheckpointThatFailsLosesNothing) {
  const std::string id = submit();
  core::Film expected = empty_film();
  for (int lease = 0; deliver_next(expected); ++lease) {
    if (lease % 2 == 0) {
      execute("ALTER TABLE tiles RENAME TO other");
      EXPECT_FALSE(coordinator().checkpointer().checkpoint());
      execute("ALTER TABLE other RENAME TO tiles");
    }
    ASSERT_EQ(pixels(id), expected.develop().pixels) << "lease " << lease;
  }
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(pixels(id), ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(FilmMemory, AnImageIsWholeWhileItsTilesComeAndGo) {
  const std::string id = submit();
  std::atomic<bool> done = false;
  std::jthread reader([&] {
    while (!done) pixels(id);
  });
  std::jthread writer([&] {
    while (!done) EXPECT_TRUE(coordinator().checkpointer().checkpoint());
  });
  core::Film expected = empty_film();
  while (deliver_next(expected)) {
  }
  done = true;
  reader.join();
  writer.join();
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(pixels(id), ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(FilmMemory, AJobWhoseTilesAloneExceedItIsRefused) {
  v1::SubmitJobRequest large = submission();
  large.mutable_overrides()->set_width_px(16384);
  large.mutable_overrides()->set_height_px(16384);
  const core::Error refused = refusal(large);
  EXPECT_EQ(refused.code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(refused.message, HasSubstr("--max-film-gib"));
}

// The row that says DONE is written after all samples.
TEST_F(FilmMemory, ADoneJobIsStoredWholeAfterCheckpointsThatFailed) {
  limits_.film_gib = 1;
  open();
  const std::string id = submit();
  work('a', 3);
  execute("ALTER TABLE tiles RENAME TO other");
  EXPECT_FALSE(coordinator().checkpointer().checkpoint());
  execute("ALTER TABLE other RENAME TO tiles");
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  std::filesystem::copy(folder_.path() / "state", folder_.path() / "copy",
                        std::filesystem::copy_options::recursive);
  open(folder_.path() / "copy");
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(job(id).samples_done(), kSamples);
}

// Samples that were counted stay, whoever needs memory when.
TEST(JobFilm, SnapshotsDoNotChange) {
  film::FilmMemory memory(1 << 30);
  const core::TileGrid grid(64, 64, core::kTilePx);
  events::RevisionCounter revisions(1);
  const auto film = film::JobFilm::make(grid, memory, revisions);
  const auto add = [&](core::SampleRange range) {
    film::Notes one;
    one.push_back({0, ready_made_tile(grid.rect(0), range)});
    film->note_addition(one, one.begin());
  };
  add({0, 2});
  film->apply();
  const film::TileSnapshot before = film->snapshot(0);
  add({2, 3});
  EXPECT_EQ(film->snapshot(0).newest, before.newest) << "notes are done by apply() alone";
  film->apply();
  const core::FilmTile first = ready_made_tile(grid.rect(0), {0, 2}),
                       all = ready_made_tile(grid.rect(0), {0, 3});
  EXPECT_EQ(before.newest->sums().sums, first.sums);
  EXPECT_EQ(film->snapshot(0).newest->sums().sums, all.sums);
  EXPECT_EQ(film->snapshot(0).newest->sums().odd_sums, all.odd_sums);
}

TEST(JobFilm, CountsItsMemory) {
  film::FilmMemory memory(1 << 30);
  const core::TileGrid grid(128, 64, core::kTilePx);
  events::RevisionCounter revisions(1);
  auto film = film::JobFilm::make(grid, memory, revisions);
  const std::uint64_t empty = memory.used_bytes();
  EXPECT_EQ(empty, 2 * film::FilmMemory::kBytesPerTile);
  film::Notes one;
  one.push_back({1, ready_made_tile(grid.rect(1), {0, 2})});
  film->note_addition(one, one.begin());
  film->apply();
  EXPECT_EQ(memory.used_bytes(), empty + static_cast<std::uint64_t>(kTileBytes));
  film::TileSnapshot held = film->snapshot(1);
  film.reset();
  EXPECT_EQ(memory.used_bytes(), static_cast<std::uint64_t>(kTileBytes)) << "somebody still has it";
  held = {};
  EXPECT_EQ(memory.used_bytes(), 0u);
}

}  // namespace
}  // namespace tessera::server
