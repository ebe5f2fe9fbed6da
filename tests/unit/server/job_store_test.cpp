// SPDX-License-Identifier: Apache-2.0
#include "server/store/job_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "server/store/state_directory.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::store {
namespace {

using core::ErrorCode;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

JobRow job_row(const std::string& id) {
  JobRow row;
  row.id = id;
  row.spec = std::string("\0spec\xff", 6);
  row.revision = 1;
  row.state = 1;
  row.spp = 16;
  row.created_ms = 1'700'000'000'000;
  return row;
}

TileRow tile_row(const std::string& job, int tile, std::string content) {
  return {job, tile, {{0, 3}, {5, 16'777'216}}, std::move(content)};
}

class JobStoreTest : public testing::Test {
 protected:
  void reopen() { store_.emplace(*JobStore::open(file_)); }
  JobStore& store() { return *store_; }

  // Runs SQL as another program could on the file.
  void meddle(const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }

  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "tessera.db";
  std::optional<JobStore> store_{*JobStore::open(file_)};
};

TEST_F(JobStoreTest, CountsItsStarts) {
  EXPECT_EQ(store().epoch(), 1u);
  reopen();
  EXPECT_EQ(store().epoch(), 2u);
}

TEST_F(JobStoreTest, AFileThatIsRemovedIsMissed) {
  EXPECT_TRUE(store().expect_file());
  std::filesystem::remove(file_);
  EXPECT_EQ(store().expect_file().error().code, ErrorCode::kDataLoss);
}

TEST_F(JobStoreTest, APathThatIsTooLongIsToldAsSuch) {
  std::filesystem::path folder = folder_.path();
  for (int i = 0; i < 6; ++i) folder /= std::string(100, 'x');
  std::filesystem::create_directories(folder);
  const auto refused = JobStore::open(folder / "tessera.db");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("shorter path"));
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

TEST_F(JobStoreTest, ATileThatChangedOnDiskIsToldByFileTileAndJob) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  for (const std::string column : {"content", "done"}) {
    ASSERT_TRUE(store().write_tiles({tile_row("a", 3, "whole")}));
    meddle("UPDATE tiles SET " + column + " = X'0000000000000000'");
    const auto damaged = store().tile("a", 3);
    ASSERT_FALSE(damaged) << column;
    EXPECT_EQ(damaged.error().code, ErrorCode::kDataLoss);
    EXPECT_THAT(damaged.error().message, HasSubstr(file_.string() + ": tile 3 of job a is damaged"));
  }
}

TEST_F(JobStoreTest, AFileThatIsNoDatabaseIsRefusedAndLeftAlone) {
  store_.reset();
  const std::string garbage(5000, 'g');
  write_file(file_, garbage);
  const auto opened = JobStore::open(file_);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(opened.error().message, HasSubstr(file_.string() + ": is damaged"));
  EXPECT_EQ(read_file(file_), garbage);
}

TEST_F(JobStoreTest, AFileOfALaterReleaseIsRefused) {
  store_.reset();
  meddle("PRAGMA user_version = 99");
  const auto opened = JobStore::open(file_);
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, HasSubstr("was written by a later release"));
}

TEST_F(JobStoreTest, AFileOfAnotherProgramIsRefusedAndLeftAlone) {
  store_.reset();
  meddle("DROP TABLE tiles; DROP TABLE jobs; PRAGMA user_version = 0");
  const std::string before = read_file(file_);
  const auto opened = JobStore::open(file_);
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, HasSubstr("a database of another program"));
  EXPECT_EQ(read_file(file_), before);
}

// Rows of the first release have no checksum.
TEST_F(JobStoreTest, AFileOfTheFirstReleaseIsTakenOver) {
  JobRow row = job_row("a");
  ASSERT_TRUE(store().insert_job(row));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, "kept")}));
  store_.reset();
  meddle(
      "ALTER TABLE jobs DROP COLUMN row_xxh3; ALTER TABLE jobs DROP COLUMN max_workers; "
      "PRAGMA user_version = 1");
  reopen();
  EXPECT_THAT(*store().jobs(), ElementsAre(row));
  EXPECT_EQ((*store().tile("a", 0))->content, "kept");
  row.revision = 2;
  ASSERT_TRUE(store().update_job(row));
  meddle("UPDATE jobs SET spp = 17");
  EXPECT_FALSE(store().jobs()->front().intact);
}

TEST_F(JobStoreTest, AFileOfTheFirstReleaseCanBeLookedAt) {
  const JobRow row = job_row("a");
  ASSERT_TRUE(store().insert_job(row));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, "kept")}));
  store_.reset();
  meddle("ALTER TABLE jobs DROP COLUMN row_xxh3; PRAGMA user_version = 1");
  const std::string before = read_file(file_);
  auto looked_at = JobStore::open_read_only(file_);
  ASSERT_TRUE(looked_at) << looked_at.error().message;
  EXPECT_THAT(looked_at->readable_jobs()->rows, ElementsAre(row));
  EXPECT_EQ((*looked_at->tile("a", 0))->content, "kept");
  EXPECT_FALSE(looked_at->insert_job(job_row("b")));
  EXPECT_EQ(read_file(file_), before);
}

TEST_F(JobStoreTest, AJobThatCannotBeReadHidesNoOther) {
  std::vector<JobRow> rows;
  for (const char* id : {"a", "b", "c"}) {
    rows.push_back(job_row(id));
    rows.back().spec = std::string(100'000, *id);  // on overflow pages of its own
    ASSERT_TRUE(store().insert_job(rows.back()));
  }
  EXPECT_THAT(store().readable_jobs()->rows, ElementsAre(rows[0], rows[1], rows[2]));
  EXPECT_EQ(store().readable_jobs()->unreadable, 0u);
  store_.reset();
  std::string bytes = read_file(file_);
  // Each of its pages begins with the number of the next.
  for (std::size_t page = 0; page < bytes.size(); page += 16384)
    if (bytes.compare(page + 4, 64, std::string(64, 'b')) == 0) bytes[page] = '\x7f';
  write_file(file_, bytes);
  auto damaged = JobStore::open_read_only(file_);
  ASSERT_TRUE(damaged);
  EXPECT_FALSE(damaged->jobs());
  const auto readable = damaged->readable_jobs();
  ASSERT_TRUE(readable);
  EXPECT_THAT(readable->rows, ElementsAre(rows[0], rows[2]));
  EXPECT_EQ(readable->unreadable, 1u);
}

TEST_F(JobStoreTest, ACountOfStartsThatIsLostCanBeLookedPast) {
  store_.reset();
  meddle("DELETE FROM meta");
  EXPECT_EQ(JobStore::open(file_).error().code, ErrorCode::kDataLoss);
  auto looked_at = JobStore::open_read_only(file_);
  ASSERT_TRUE(looked_at) << looked_at.error().message;
  EXPECT_EQ(looked_at->epoch(), 0u);
}

TEST_F(JobStoreTest, ALogIsEmptiedWholeOrNotAtAll) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  sqlite3* reader = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &reader), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(reader, "BEGIN; SELECT * FROM jobs", nullptr, nullptr, nullptr), SQLITE_OK);
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, "new")}));
  EXPECT_FALSE(store().truncate_wal()) << "a reader is in the way";
  sqlite3_close(reader);
  EXPECT_TRUE(store().truncate_wal());
  EXPECT_EQ(std::filesystem::file_size(file_.string() + "-wal"), 0u);
}

TEST_F(JobStoreTest, ALogWithoutItsDatabaseIsLeftAlone) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  const TemporaryFolder crashed;
  const auto database = crashed.path() / "tessera.db", log = crashed.path() / "tessera.db-wal";
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, "of the log alone")}));
  for (const bool is_there : {false, true}) {
    if (is_there) write_file(database, "");
    std::filesystem::copy_file(file_.string() + "-wal", log,
                               std::filesystem::copy_options::overwrite_existing);
    const std::string before = read_file(log);
    ASSERT_FALSE(before.empty());
    for (const bool may_be_new : {false, true})
      EXPECT_EQ(JobStore::open(database, may_be_new).error().code, ErrorCode::kDataLoss);
    EXPECT_EQ(JobStore::open_read_only(database).error().code, ErrorCode::kDataLoss);
    EXPECT_EQ(std::filesystem::exists(database), is_there);
    EXPECT_TRUE(read_file(log) == before);
  }
}

// Otherwise intact pages of the log would be written among damaged ones.
TEST_F(JobStoreTest, ADamagedFileThatIsRefusedIsLeftAsItWasWithItsLog) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, std::string(200'000, 'x'))}));
  ASSERT_TRUE(store().truncate_wal());
  ASSERT_TRUE(store().write_tiles({tile_row("a", 1, "of the log alone")}));
  const TemporaryFolder crashed;
  const auto database = crashed.path() / "tessera.db", log = crashed.path() / "tessera.db-wal";
  std::string bytes = read_file(file_);
  for (std::size_t page = 16384; page < bytes.size(); page += 16384)
    if (bytes.compare(page + 4, 64, std::string(64, 'x')) == 0) bytes[page] = '\x7f';
  write_file(database, bytes);
  std::filesystem::copy_file(file_.string() + "-wal", log);
  const std::string before = read_file(log);
  ASSERT_FALSE(before.empty());
  EXPECT_EQ(JobStore::open(database).error().code, ErrorCode::kDataLoss);
  EXPECT_TRUE(read_file(database) == bytes);
  ASSERT_TRUE(std::filesystem::exists(log));
  EXPECT_TRUE(read_file(log) == before);
}

TEST_F(JobStoreTest, AJobWhoseRowChangedOnDiskIsNotIntact) {
  JobRow row = job_row("a");
  row.request_id = "request";
  row.counters = row.arithmetic = row.failure = "x";
  row.finished_ms = 5;
  ASSERT_TRUE(store().insert_job(row));
  for (const char* change : {"id = 'b'", "request_id = NULL", "spec = X'00'", "revision = 7", "state = 2",
                             "failure = ''", "spp = 15", "priority = 1", "created_ms = 0",
                             "finished_ms = NULL", "counters = X''", "arithmetic = 'y'", "max_workers = 1"}) {
    ASSERT_TRUE(store().delete_job("a"));
    ASSERT_TRUE(store().delete_job("b"));
    ASSERT_TRUE(store().insert_job(row));
    ASSERT_TRUE(store().jobs()->front().intact);
    meddle(std::string("UPDATE jobs SET ") + change);
    EXPECT_FALSE(store().jobs()->front().intact) << change;
  }
}

TEST(StateDirectory, IsForOneCoordinatorAtATime) {
  const TemporaryFolder folder;
  auto first = StateDirectory::open(folder.path() / "state");
  ASSERT_TRUE(first);
  const auto second = StateDirectory::open(folder.path() / "state");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(second.error().message, HasSubstr("another coordinator runs on"));
}

TEST(StateDirectory, IsFreeAgainAfterwards) {
  const TemporaryFolder folder;
  ASSERT_TRUE(StateDirectory::open(folder.path()));
  EXPECT_TRUE(StateDirectory::open(folder.path()));
}

TEST_F(JobStoreTest, AFileOfBeforeThereWereLimitsOnWorkersIsTakenOver) {
  JobRow job = job_row("a");
  ASSERT_TRUE(store().insert_job(job));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 3, "content")}));
  store_.reset();
  meddle("ALTER TABLE jobs DROP COLUMN max_workers; PRAGMA user_version = 2");
  for (int start = 0; start < 2; ++start) {
    reopen();
    EXPECT_THAT(*store().jobs(), ElementsAre(job));
    EXPECT_TRUE(*store().tile("a", 3));
  }
  job.revision = 2;
  job.max_workers = 7;
  ASSERT_TRUE(store().update_job(job));
  reopen();
  EXPECT_THAT(*store().jobs(), ElementsAre(job));
}

}  // namespace
}  // namespace tessera::store
