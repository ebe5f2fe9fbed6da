// SPDX-License-Identifier: Apache-2.0
// Database files that are damaged, of other releases or of other programs.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <fstream>
#include <vector>

#include "server/store/state_directory.hpp"
#include "tests/unit/server/job_store_fixture.hpp"

namespace tessera::store {
namespace {

using core::ErrorCode;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class StoreFiles : public JobStoreTest {};

TEST_F(StoreFiles, AFileThatIsRemovedIsMissed) {
  EXPECT_TRUE(store().expect_file());
  std::filesystem::remove(file_);
  EXPECT_EQ(store().expect_file().error().code, ErrorCode::kDataLoss);
  EXPECT_EQ(store().insert_job(job_row("a")).error().code, ErrorCode::kDataLoss)
      << "a job that is acknowledged has to survive a restart";
}

TEST_F(StoreFiles, ATooLongPathIsReported) {
  std::filesystem::path folder = folder_.path();
  for (int i = 0; i < 6; ++i) folder /= std::string(100, 'x');
  std::filesystem::create_directories(folder);
  const auto refused = JobStore::open(folder / "tessera.db");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("shorter path"));
}

TEST_F(StoreFiles, AChangedTileIsReportedByFileTileAndJob) {
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

TEST_F(StoreFiles, AFileThatIsNoDatabaseIsRefusedAndLeftAlone) {
  store_.reset();
  const std::string garbage(5000, 'g');
  write_file(file_, garbage);
  const auto opened = JobStore::open(file_);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(opened.error().message, HasSubstr(file_.string() + ": is damaged"));
  EXPECT_EQ(read_file(file_), garbage);
}

TEST_F(StoreFiles, AFileOfALaterReleaseIsRefused) {
  store_.reset();
  meddle("PRAGMA user_version = 99");
  const auto opened = JobStore::open(file_);
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, HasSubstr("was written by a later release"));
}

TEST_F(StoreFiles, AFileOfAnotherProgramIsRefusedAndLeftAlone) {
  store_.reset();
  meddle("DROP TABLE tiles; DROP TABLE jobs; PRAGMA user_version = 0");
  const std::string before = read_file(file_);
  const auto opened = JobStore::open(file_);
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, HasSubstr("a database of another program"));
  EXPECT_EQ(read_file(file_), before);
}

// Rows of the first release have no checksum.
TEST_F(StoreFiles, AFileOfTheFirstReleaseIsTakenOver) {
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

TEST_F(StoreFiles, AFileOfTheFirstReleaseCanBeLookedAt) {
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

TEST_F(StoreFiles, AJobThatCannotBeReadHidesNoOther) {
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

TEST_F(StoreFiles, ACountOfStartsThatIsLostCanBeLookedPast) {
  store_.reset();
  meddle("DELETE FROM meta");
  EXPECT_EQ(JobStore::open(file_).error().code, ErrorCode::kDataLoss);
  auto looked_at = JobStore::open_read_only(file_);
  ASSERT_TRUE(looked_at) << looked_at.error().message;
  EXPECT_EQ(looked_at->epoch(), 0u);
}

TEST_F(StoreFiles, ALogIsEmptiedWholeOrNotAtAll) {
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

TEST_F(StoreFiles, ALogWithoutItsDatabaseIsLeftAlone) {
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
TEST_F(StoreFiles, ADamagedFileThatIsRefusedIsLeftAsItWasWithItsLog) {
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

TEST_F(StoreFiles, AJobWhoseRowChangedOnDiskIsNotIntact) {
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

TEST_F(StoreFiles, AListDoesNotReadBundlesAndStillFindsDamage) {
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

TEST_F(StoreFiles, AFileOfAnEarlierReleaseShrinksAsWell) {
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

TEST_F(StoreFiles, NothingIsWrittenToAFileThatTurnsOutToBeDamaged) {
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

TEST(StateDirectory, IsForOneCoordinatorEvenWithoutItsLockFile) {
  const TemporaryFolder folder;
  const auto first = StateDirectory::open(folder.path());
  ASSERT_TRUE(first);
  for (const bool is_made_again : {false, true}) {
    std::filesystem::remove(folder.path() / "lock");
    if (is_made_again) write_file(folder.path() / "lock", "");
    EXPECT_EQ(StateDirectory::open(folder.path()).error().code, ErrorCode::kFailedPrecondition);
    EXPECT_EQ(lock_existing_state(folder.path()).error().code, ErrorCode::kFailedPrecondition) << "--check";
    EXPECT_EQ(lock_state_to_mend(folder.path()).error().code, ErrorCode::kFailedPrecondition) << "--salvage";
    EXPECT_EQ(lock_new_state(folder.path()).error().code, ErrorCode::kFailedPrecondition) << "--restore";
    EXPECT_TRUE(copy_database(folder.path(), folder.path() / (is_made_again ? "copy-2" : "copy-1")))
        << "--backup reads beside the coordinator";
  }
  std::filesystem::remove(folder.path() / "lock");
}

// A backup of a state whose lock file is gone holds the coordinator's start off, too.
TEST(StateDirectory, IsLockedWhileItIsRead) {
  const TemporaryFolder folder;
  ASSERT_TRUE(StateDirectory::open(folder.path()));
  std::filesystem::remove(folder.path() / "lock");
  {
    const auto reading = lock_existing_state(folder.path());
    ASSERT_TRUE(reading) << reading.error().message;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "lock")) << "reading creates nothing";
    EXPECT_EQ(StateDirectory::open(folder.path()).error().code, ErrorCode::kFailedPrecondition);
  }
  EXPECT_TRUE(StateDirectory::open(folder.path()));
}

TEST(StateDirectory, IsFreeAgainAfterwards) {
  const TemporaryFolder folder;
  ASSERT_TRUE(StateDirectory::open(folder.path()));
  EXPECT_TRUE(StateDirectory::open(folder.path()));
}

TEST_F(StoreFiles, AFileOfBeforeThereWereValidationsIsTakenOver) {
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

TEST_F(StoreFiles, AFileOfBeforeThereWereLimitsOnWorkersIsTakenOver) {
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
