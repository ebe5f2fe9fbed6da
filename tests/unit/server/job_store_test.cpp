// SPDX-License-Identifier: Apache-2.0
#include "server/store/job_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <atomic>
#include <fstream>
#include <thread>

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

  // Takes back the changes of the schema since this version.
  void make_of_version(int version) {
    store_.reset();
    const auto drop_columns = [this](std::initializer_list<std::string> columns) {
      for (const std::string& column : columns) meddle("ALTER TABLE jobs DROP COLUMN " + column);
    };
    if (version < 7) {
      meddle("DROP INDEX jobs_by_number; DROP INDEX jobs_unsettled; DROP INDEX jobs_by_end");
      meddle("DROP TABLE deleted_jobs");
      drop_columns({"owner", "producers", "settled", "number", "bundle_xxh3", "bundle"});
    }
    if (version < 6) drop_columns({"failure_details", "submission"});
    if (version < 5) meddle("DROP TABLE quarantine");
    if (version < 4) meddle("DROP TRIGGER tile_deleted; DROP TABLE tile_revisions");
    if (version < 3) drop_columns({"max_workers"});
    if (version < 2) drop_columns({"row_xxh3"});
    meddle("PRAGMA user_version = " + std::to_string(version));
  }

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
  make_of_version(1);
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
  make_of_version(1);
  const std::string before = read_file(file_);
  auto looked_at = JobStore::open_read_only(file_);
  ASSERT_TRUE(looked_at) << looked_at.error().message;
  EXPECT_THAT(looked_at->readable_jobs()->rows, ElementsAre(row));
  EXPECT_EQ((*looked_at->tile("a", 0))->content, "kept");
  EXPECT_THAT(*looked_at->quarantine(), IsEmpty());
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

TEST_F(JobStoreTest, AJobWhoseRowChangedOnDiskIsNotIntact) {
  JobRow row = job_row("a");
  row.request_id = "request";
  row.counters = row.arithmetic = row.failure = row.bundle = row.owner = row.producers = "x";
  row.finished_ms = 5;
  ASSERT_TRUE(store().insert_job(row));
  for (const char* change :
       {"id = 'b'", "request_id = NULL", "spec = X'00'", "revision = 7", "state = 2", "failure = ''",
        "spp = 15", "priority = 1", "created_ms = 0", "finished_ms = NULL", "counters = X''",
        "arithmetic = 'y'", "max_workers = 1", "bundle = X'00'", "bundle = X''", "bundle_xxh3 = NULL",
        "owner = ''", "producers = X''"}) {
    ASSERT_TRUE(store().delete_job("a"));
    ASSERT_TRUE(store().delete_job("b"));
    ASSERT_TRUE(store().insert_job(row));
    ASSERT_TRUE(store().jobs()->front().intact);
    meddle(std::string("UPDATE jobs SET ") + change);
    EXPECT_FALSE(store().jobs()->front().intact) << change;
  }
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

TEST_F(JobStoreTest, AListDoesNotReadBundlesAndStillFindsDamage) {
  JobRow row = job_row("a");
  row.bundle = "bundle";
  ASSERT_TRUE(store().insert_job(row));
  const auto listed = [&] {
    JobRow found;
    EXPECT_TRUE(store().list_jobs({}, 1, [&](const JobRow& each, std::int64_t) { found = each; }));
    return found;
  };
  EXPECT_EQ(listed().bundle, "");
  EXPECT_TRUE(listed().intact);
  EXPECT_EQ((*store().job("a"))->bundle, "bundle");
  meddle("UPDATE jobs SET failure = 'x'");
  EXPECT_FALSE(listed().intact);
}

TEST_F(JobStoreTest, AStartIsToldOfJobsThatAreNotSettled) {
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

TEST_F(JobStoreTest, AFileOfAnEarlierReleaseShrinksAsWell) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  make_of_version(3);
  meddle("PRAGMA journal_mode = DELETE; PRAGMA auto_vacuum = NONE; VACUUM");
  reopen();
  for (int tile = 0; tile < 100; ++tile)
    ASSERT_TRUE(store().write_tiles({tile_row("a", tile, std::string(100'000, 'x'))}));
  ASSERT_TRUE(store().truncate_wal());
  const auto before = std::filesystem::file_size(file_);
  ASSERT_TRUE(store().delete_job("a"));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(store().remove_deleted_tiles());
  ASSERT_TRUE(store().truncate_wal());
  EXPECT_LT(std::filesystem::file_size(file_), before);
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

TEST_F(JobStoreTest, NothingIsWrittenToAFileThatTurnsOutToBeDamaged) {
  ASSERT_TRUE(store().insert_job(job_row("a")));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 0, std::string(200'000, 'x'))}));
  EXPECT_TRUE(store().check_rest({}));
  ASSERT_TRUE(store().truncate_wal());
  std::string bytes = read_file(file_);
  for (std::size_t page = 16384; page < bytes.size(); page += 16384) {
    if (bytes.compare(page + 4, 64, std::string(64, 'x')) != 0) continue;
    std::fstream file(file_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(page)).put('\x7f');
  }
  EXPECT_EQ(store().check_rest({}).error().code, ErrorCode::kDataLoss);
  JobRow row = job_row("a");
  row.revision = 2;
  EXPECT_EQ(store().update_job(row).error().code, ErrorCode::kDataLoss);
  EXPECT_EQ((*store().job("a"))->revision, 1u);
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

TEST_F(JobStoreTest, AFileOfBeforeThereWereValidationsIsTakenOver) {
  JobRow job = job_row("a");
  ASSERT_TRUE(store().insert_job(job));
  make_of_version(4);
  for (int start = 0; start < 2; ++start) {
    reopen();
    EXPECT_THAT(*store().jobs(), ElementsAre(job)) << "the checksum counts what there was then";
  }
  job.revision = 2;
  job.failure_details = "why";
  ASSERT_TRUE(store().update_job(job));
  reopen();
  EXPECT_THAT(*store().jobs(), ElementsAre(job));
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

TEST_F(JobStoreTest, AFileOfBeforeThereWereLimitsOnWorkersIsTakenOver) {
  JobRow job = job_row("a");
  ASSERT_TRUE(store().insert_job(job));
  ASSERT_TRUE(store().write_tiles({tile_row("a", 3, "content")}));
  make_of_version(2);
  for (int start = 0; start < 2; ++start) {
    reopen();
    EXPECT_THAT(*store().jobs(), ElementsAre(job));
    EXPECT_TRUE(*store().tile("a", 3));
    EXPECT_THAT(*store().tile_changes("a", 0, 10), ElementsAre(TileChange{4, 3}));
  }
  job.revision = 2;
  job.max_workers = 7;
  ASSERT_TRUE(store().update_job(job));
  reopen();
  EXPECT_THAT(*store().jobs(), ElementsAre(job));
}

}  // namespace
}  // namespace tessera::store
