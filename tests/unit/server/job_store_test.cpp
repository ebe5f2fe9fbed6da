// SPDX-License-Identifier: Apache-2.0
// What the job store keeps, lists and deletes.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <atomic>
#include <thread>
#include <vector>

#include "tests/unit/server/job_store_fixture.hpp"

namespace tessera::store {
namespace {

using core::ErrorCode;
using testing::ElementsAre;
using testing::IsEmpty;

TEST_F(JobStoreTest, CountsItsStarts) {
  EXPECT_EQ(store().epoch(), 1u);
  reopen();
  EXPECT_EQ(store().epoch(), 2u);
}

TEST_F(JobStoreTest, KeepsTheQuarantine) {
  ASSERT_TRUE(store().write_quarantine("b", "second"));
  ASSERT_TRUE(store().write_quarantine("a", "first"));
  ASSERT_TRUE(store().write_quarantine("b", std::string("\0changed", 8)));
  reopen();
  EXPECT_THAT(*store().quarantine(),
              ElementsAre(QuarantineRow{"a", "first"}, QuarantineRow{"b", std::string("\0changed", 8)}));
  EXPECT_TRUE(store().delete_quarantine("a"));
  EXPECT_TRUE(store().delete_quarantine("a"));
  meddle("UPDATE quarantine SET content = 'other'");
  EXPECT_THAT(*store().quarantine(), ElementsAre(QuarantineRow{"b", "other", false}));
}

TEST_F(JobStoreTest, RestoresJobsInTheOrderOfTheirAge) {
  JobRow first = job_row("b"), second = job_row("a");
  first.request_id = "request";
  second.created_ms += 1;
  second.finished_ms = second.created_ms + 5;
  second.failure = "three workers died over it";
  second.counters = std::string("\0\1", 2);
  second.arithmetic = "0123";
  second.priority = -3;
  second.max_workers = 4'000'000'000;
  ASSERT_TRUE(store().insert_job(second));
  ASSERT_TRUE(store().insert_job(first));
  reopen();
  EXPECT_THAT(*store().jobs(), ElementsAre(first, second));
}

TEST_F(JobStoreTest, OneRequestMakesOneJobButManyMayHaveNone) {
  JobRow first = job_row("a"), second = job_row("b");
  first.request_id = second.request_id = "request";
  ASSERT_TRUE(store().insert_job(first));
  EXPECT_FALSE(store().insert_job(second));
  EXPECT_TRUE(store().insert_job(job_row("c")));
  EXPECT_TRUE(store().insert_job(job_row("d")));
}

TEST_F(JobStoreTest, TheLaterRevisionWinsInWhicheverOrderTheyAreWritten) {
  JobRow row = job_row("a");
  ASSERT_TRUE(store().insert_job(row));
  JobRow older = row, newer = row;
  older.revision = 2;
  older.state = 2;
  newer.revision = 3;
  newer.state = 4;
  newer.spp = 64;
  ASSERT_TRUE(store().update_job(newer));
  ASSERT_TRUE(store().update_job(older));
  EXPECT_THAT(*store().jobs(), ElementsAre(newer));
}

TEST_F(JobStoreTest, RestoresTiles) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  const TileRow first = tile_row("a", 0, std::string(200'000, 'x')), second = tile_row("a", 7, "old");
  ASSERT_TRUE(store().write_tiles({first, second}));
  const TileRow rewritten{"a", 7, {{0, 4}}, "new"};
  ASSERT_TRUE(store().write_tiles({rewritten}));
  reopen();
  EXPECT_EQ(*store().tile("a", 0), first);
  EXPECT_EQ(*store().tile("a", 7), rewritten);
  EXPECT_EQ(*store().tile("a", 1), std::nullopt);
  const auto done = store().tiles_done("a");
  ASSERT_TRUE(done);
  EXPECT_EQ(*done, (std::map<int, std::vector<core::SampleRange>>{{0, first.done}, {7, rewritten.done}}));
}

TEST_F(JobStoreTest, ADeletedJobTakesItsTilesAlongAndGetsNoMore) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, "x")}));
  ASSERT_TRUE(store().delete_job("a"));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 1, "late")}));
  EXPECT_THAT(*store().jobs(), IsEmpty());
  ASSERT_TRUE(store().remove_deleted_tiles());
  EXPECT_THAT(*store().tiles_done("a"), IsEmpty());
}

// Removing all tiles of a large job takes seconds, for which all others would wait.
TEST_F(JobStoreTest, TilesOfADeletedJobGoAFewAtATimeAlsoAfterARestart) {
  ASSERT_TRUE(store().insert_job(job_row("a")) && store().insert_job(job_row("b")));
  std::vector<TileRow> tiles;
  for (int i = 0; i < 1000; ++i) tiles.push_back(tile_row("a", i, "x"));
  tiles.push_back(tile_row("b", 0, "kept"));
  ASSERT_TRUE(store().write_tiles(tiles));
  ASSERT_TRUE(store().delete_job("a"));
  EXPECT_EQ(store().tiles_done("a")->size(), 1000u);
  ASSERT_TRUE(store().remove_deleted_tiles());
  const std::size_t left = store().tiles_done("a")->size();
  EXPECT_GT(left, 500u);
  EXPECT_LT(left, 1000u);
  reopen();
  EXPECT_EQ(store().tiles_done("a")->size(), left);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(store().remove_deleted_tiles());
  EXPECT_THAT(*store().tiles_done("a"), IsEmpty());
  EXPECT_EQ(store().tiles_done("b")->size(), 1u);
}

TEST_F(JobStoreTest, ATileThatCannotBeWrittenTakesTheWholeCheckpointBack) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, "before")}));
  meddle("CREATE TRIGGER full BEFORE INSERT ON tiles WHEN NEW.tile = 9 BEGIN SELECT RAISE(ABORT, 'no'); END");
  EXPECT_FALSE(store().write_tiles({tile_row("a", 0, "after"), tile_row("a", 9, "refused")}));
  EXPECT_EQ((*store().tile("a", 0))->content, "before");
  // The store is usable afterwards.
  EXPECT_TRUE(store().write_tiles({tile_row("a", 0, "later")}));
}

TEST_F(JobStoreTest, WhatACrashLeavesIsTheLastCheckpoint) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, "kept")}));
  // A copy of the files on disk without closing the store, as after kill -9.
  const TemporaryFolder crashed;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    std::filesystem::copy(entry, crashed.path() / entry.path().filename());
  }
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, "lost")}));
  auto after = JobStore::open(crashed.path() / "tessera.db");
  ASSERT_TRUE(after);
  EXPECT_EQ((*after->tile("a", 0))->content, "kept");
}

TEST_F(JobStoreTest, KeepsTheOrderOfChangesOfTiles) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  const auto write = [&](int tile, std::uint64_t revision) {
    TileRow row = tile_row("a", tile, "x");
    row.revision = revision;
    ASSERT_TRUE(store().write_tiles({row}));
  };
  write(0, 100);
  write(1, 101);
  write(2, 102);
  write(0, 103);
  EXPECT_THAT(*store().tile_changes("a", 0, 10),
              ElementsAre(TileChange{101, 1}, TileChange{102, 2}, TileChange{103, 0}));
  reopen();
  EXPECT_THAT(*store().tile_changes("a", 101, 1), ElementsAre(TileChange{102, 2}));
  EXPECT_THAT(*store().tile_changes("a", 103, 10), testing::IsEmpty());
  EXPECT_THAT(*store().tile_changes("b", 0, 10), testing::IsEmpty());
  ASSERT_TRUE(store().delete_job("a"));
  ASSERT_TRUE(store().remove_deleted_tiles());
  EXPECT_THAT(*store().tile_changes("a", 0, 10), testing::IsEmpty());
}

std::vector<std::string> ids_of(JobStore& store, const JobQuery& query, std::size_t limit = 100) {
  std::vector<std::string> ids;
  EXPECT_TRUE(store.list_jobs(query, limit, [&](const JobRow& row, std::int64_t) { ids.push_back(row.id); }));
  return ids;
}

TEST_F(JobStoreTest, ListsJobsNewestFirstByWhatIsAsked) {
  for (const char* id : {"aa", "ab", "b"}) {
    JobRow row = job_row(id);
    row.owner = row.id == "b" ? "" : "ann";
    row.bundle = "large";
    row.state = row.id == "aa" ? 3 : 4;
    row.created_ms += static_cast<std::int64_t>(row.id.size());
    row.settled = true;
    ASSERT_TRUE(store().insert_job(row));
  }
  JobQuery query;
  EXPECT_THAT(ids_of(store(), query), ElementsAre("b", "ab", "aa"));
  EXPECT_THAT(ids_of(store(), query, 2), ElementsAre("b", "ab"));
  query.before_number = 3;
  EXPECT_THAT(ids_of(store(), query), ElementsAre("ab", "aa"));
  query.states = 1u << 4;
  EXPECT_THAT(ids_of(store(), query), ElementsAre("ab"));
  query = {};
  query.id_prefix = "a";
  EXPECT_THAT(ids_of(store(), query), ElementsAre("ab", "aa"));
  query.before_number = 2;
  EXPECT_THAT(ids_of(store(), query), ElementsAre("aa"));
  query = {};
  query.owner = "";
  EXPECT_THAT(ids_of(store(), query), ElementsAre("b"));
  query = {};
  query.created_from_ms = job_row("").created_ms + 2;
  EXPECT_THAT(ids_of(store(), query), ElementsAre("ab", "aa"));
  query.created_before_ms = query.created_from_ms;
  EXPECT_THAT(ids_of(store(), query), IsEmpty());
}

// Their rows may be older than their state.
TEST_F(JobStoreTest, JobsThatAreNotSettledAreListedWhateverTheStateOfTheirRows) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  JobQuery query;
  query.states = 1u << 5;
  EXPECT_THAT(ids_of(store(), query), ElementsAre("a"));
}

TEST_F(JobStoreTest, UnfinishedJobsAreRestored) {
  JobRow settled = job_row("a"), other = job_row("b");
  settled.settled = true;
  settled.finished_ms = 7;
  ASSERT_TRUE(store().insert_job(settled) && store().insert_job(other));
  EXPECT_THAT(*store().unsettled_jobs(), ElementsAre("b"));
  EXPECT_EQ(*store().settled_count(), 1u);
  EXPECT_THAT(*store().first_settled(7, 9), IsEmpty());
  EXPECT_THAT(*store().first_settled(8, 9), ElementsAre("a"));
  other.revision = 5;
  ASSERT_TRUE(store().update_job(other));
  other.settled = true;
  other.revision = 4;
  ASSERT_TRUE(store().settle_jobs({other}));
  EXPECT_EQ(*store().settled_count(), 1u) << "the store has a later revision";
  other.revision = 6;
  ASSERT_TRUE(store().settle_jobs({other}));
  EXPECT_EQ(*store().settled_count(), 2u);
  EXPECT_THAT(*store().unsettled_jobs(), IsEmpty());
}

TEST_F(JobStoreTest, ARowIsReplacedIfItHasTheExpectedRevision) {
  JobRow row = job_row("a");
  ASSERT_TRUE(store().insert_job(row));
  row.revision = 5;
  row.spec = "other";
  row.bundle = "new";
  EXPECT_FALSE(*store().replace_job(row, 4));
  EXPECT_TRUE(*store().replace_job(row, 1));
  EXPECT_EQ(**store().job("a"), row);
  EXPECT_EQ(*store().job("b"), std::nullopt);
  EXPECT_EQ(*store().job_of_request("none"), std::nullopt);
}

TEST_F(JobStoreTest, OneChangeOfAGroupFailsAlone) {
  JobRow first = job_row("a");
  first.request_id = "request";
  ASSERT_TRUE(store().insert_job(first));
  std::vector<std::thread> threads;
  std::atomic<int> inserted{0}, refused{0};
  for (int i = 0; i < 64; ++i) {
    threads.emplace_back([&, i] {
      JobRow row = job_row("job" + std::to_string(i));
      if (i % 4 == 0) row.request_id = "request";
      ++(store().insert_job(row) ? inserted : refused);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(inserted, 48);
  EXPECT_EQ(refused, 16);
  EXPECT_EQ(store().jobs()->size(), 49u);
}

TEST_F(JobStoreTest, AFileShrinksWhenALargeJobIsDeleted) {
  ASSERT_TRUE(store().insert_job(job_row("a")) && store().insert_job(job_row("b")));
  ASSERT_TRUE(store().write_tiles({tile_row("b", 0, "kept")}));
  for (int tile = 0; tile < 300; ++tile)
    ASSERT_TRUE(store().write_tiles({tile_row("a", tile, std::string(100'000, static_cast<char>(tile)))}));
  ASSERT_TRUE(store().truncate_wal());
  const auto before = std::filesystem::file_size(file_);
  ASSERT_TRUE(store().delete_job("a"));
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(store().remove_deleted_tiles());
  ASSERT_TRUE(store().truncate_wal());
  EXPECT_LT(std::filesystem::file_size(file_), before / 4);
  EXPECT_EQ((*store().tile("b", 0))->content, "kept");
  EXPECT_THAT(*store().structural_damage(), IsEmpty());
}

// A reader that begins before a transaction ends does not wait for it.
TEST_F(JobStoreTest, ReadersDoNotWaitForAWriter) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  sqlite3* writer = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &writer), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(writer, "BEGIN IMMEDIATE; DELETE FROM jobs", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_TRUE(*store().job("a"));
  EXPECT_EQ(store().update_job(job_row("a")).error().code, ErrorCode::kUnavailable);
  sqlite3_close(writer);
}

TEST_F(JobStoreTest, TheEndOfAValidationReplacesTheSpec) {
  JobRow job = job_row("a");
  job.submission = "overrides";
  ASSERT_TRUE(store().insert_job(job));
  job.revision = 2;
  job.spec = "validated";
  job.submission.clear();
  ASSERT_TRUE(store().end_validation(job));
  reopen();
  EXPECT_THAT(*store().jobs(), ElementsAre(job));
  EXPECT_TRUE(store().jobs()->front().intact);
  JobRow late = job;
  late.spec = "late";
  ASSERT_TRUE(store().end_validation(late)) << "the store has this revision: nothing changes";
  EXPECT_THAT(*store().jobs(), ElementsAre(job));
}

}  // namespace
}  // namespace tessera::store
