// SPDX-License-Identifier: Apache-2.0
#include "server/admin/state_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "server/store/replacement.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class StateCheck : public ScriptedFarm {
 protected:
  std::filesystem::path state() const { return folder_.path() / "state"; }
  void close() { coordinator_.reset(); }

  void meddle(const std::string& sql) {
    close();
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((state() / "tessera.db").c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }
  // Stores a done job and an unfinished one.
  void fill() {
    done_ = submit();
    work('a');
    running_ = submit();
    work('b', 3);
    ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  }

  std::string done_, running_;
};

TEST_F(StateCheck, FindsNothingWrongWithASoundState) {
  fill();
  const std::uint64_t samples = job(running_).samples_done();
  ASSERT_EQ(admin::check_state(state()).error().code, ErrorCode::kFailedPrecondition)
      << "a coordinator runs on it";
  close();
  const auto findings = admin::check_state(state());
  ASSERT_TRUE(findings) << findings.error().message;
  EXPECT_TRUE(findings->whole());
  ASSERT_EQ(findings->jobs.size(), 2u);
  EXPECT_EQ(findings->jobs[0].samples_done, kSamples);
  EXPECT_EQ(findings->jobs[1].samples_done, samples);
  EXPECT_EQ(findings->jobs[1].samples_total, kSamples);
  EXPECT_EQ(findings->blobs, 1u);
  EXPECT_THAT(findings->notes, IsEmpty());
}

TEST_F(StateCheck, NamesWhatIsDamagedAndWhatToDo) {
  fill();
  meddle("UPDATE tiles SET content = X'00' WHERE tile = 1");
  const auto tiles = admin::check_state(state());
  ASSERT_TRUE(tiles);
  EXPECT_FALSE(tiles->whole());
  EXPECT_THAT(tiles->jobs[0].damage, ElementsAre(AllOf(HasSubstr("tile 1"), HasSubstr("--salvage"))));
  EXPECT_THAT(tiles->jobs[1].damage, ElementsAre(AllOf(HasSubstr("tile 1"), HasSubstr("rendered again"))));

  meddle("UPDATE jobs SET spp = 5 WHERE id = '" + done_ + "'");
  EXPECT_THAT(admin::check_state(state())->jobs[0].damage,
              ElementsAre(HasSubstr("the stored job " + done_ + " is damaged")));

  meddle("UPDATE jobs SET id = CAST(X'6AFF0A' AS TEXT) WHERE id = '" + done_ + "'");
  EXPECT_THAT(admin::to_text(*admin::check_state(state())),
              AllOf(HasSubstr("job j\\xff\\x0a  ?"), HasSubstr("the stored job j\\xff\\x0a is damaged")));

  const auto blob = blobs::BlobStore::look_at(state() / "blobs").path(proto::digest_of(kSceneBytes));
  write_file(blob, "[}");
  EXPECT_THAT(admin::to_text(*admin::check_state(state())),
              AllOf(HasSubstr(blob.string()), HasSubstr("submit the scene again")));
  std::filesystem::remove(blob);
  EXPECT_THAT(to_text(*admin::check_state(state())), HasSubstr("is missing"));
  write_file(state() / "blobs" / "incoming" / "half", "x");
  EXPECT_THAT(admin::check_state(state())->notes, ElementsAre(HasSubstr("1 interrupted upload")));
}

TEST_F(StateCheck, IsForStatesOnly) {
  EXPECT_EQ(admin::check_state(folder_.path()).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(admin::salvage_state(folder_.path()).error().code, ErrorCode::kNotFound);
}

TEST_F(StateCheck, SalvageKeepsWhatIsWholeAndTheRestIsRenderedAgain) {
  fill();
  const std::string lost = submit();
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  meddle("UPDATE tiles SET content = X'00' WHERE tile = 1; UPDATE jobs SET spp = 5 WHERE id = '" + lost +
         "'");
  const auto salvage = admin::salvage_state(state());
  ASSERT_TRUE(salvage) << salvage.error().message;
  EXPECT_EQ(salvage->jobs, 2u);
  EXPECT_EQ(salvage->lost_jobs, 1u);
  EXPECT_EQ(salvage->lost_tiles, 2u);
  EXPECT_TRUE(std::filesystem::exists(salvage->set_aside));
  EXPECT_TRUE(admin::check_state(state())->whole());
  open();
  EXPECT_EQ(job(done_).state(), v1::JOB_STATE_RUNNING);
  work('c');
  for (const std::string& id : {done_, running_}) {
    EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
    EXPECT_EQ(coordinator().images().get(id)->image.pixels,
              ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
  }
}

TEST_F(StateCheck, LostTilesOfACancelledJobAreReported) {
  const std::string id = submit();
  work('a', 3);
  ASSERT_TRUE(coordinator().jobs().cancel(id));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  meddle("UPDATE tiles SET content = X'00' WHERE tile = (SELECT min(tile) FROM tiles)");
  EXPECT_THAT(admin::check_state(state())->jobs[0].damage, ElementsAre(HasSubstr("it is lost")));
  const auto salvage = admin::salvage_state(state());
  ASSERT_TRUE(salvage) << salvage.error().message;
  EXPECT_EQ(salvage->lost_tiles, 0u);
  EXPECT_EQ(salvage->tiles_lost_for_good, 1u);
}

TEST_F(StateCheck, AMissingTileOfAFinishedJobIsReported) {
  fill();
  meddle("DELETE FROM tiles WHERE tile = 1 AND job_id = '" + done_ + "'");
  const auto damaged = admin::check_state(state());
  EXPECT_FALSE(damaged->whole());
  EXPECT_THAT(admin::to_text(*damaged), HasSubstr("some of its tiles are missing: --salvage"));
  meddle("UPDATE jobs SET settled = 0");
  EXPECT_THAT(admin::check_state(state())->notes,
              ElementsAre(HasSubstr("samples of job " + done_ + " are missing")));
}

TEST_F(StateCheck, SalvageGoesOnFromAGreaterCountOfStarts) {
  fill();
  meddle("DELETE FROM meta");
  EXPECT_THAT(admin::check_state(state())->damage, ElementsAre(HasSubstr("lost the count of its starts")));
  ASSERT_TRUE(admin::salvage_state(state()));
  auto jobs = store::JobStore::open(state() / "tessera.db");
  ASSERT_TRUE(jobs);
  EXPECT_GT(jobs->epoch(), 1'000'000u);
  EXPECT_LT(jobs->epoch(), 1u << 24);
}

TEST_F(StateCheck, SalvageKeepsAJobOnceHoweverOftenItIsListed) {
  fill();
  // Like damaged pages: without the indexes that would prevent duplicates.
  meddle(
      "CREATE TABLE twice AS SELECT * FROM jobs; DROP TABLE jobs; CREATE TABLE jobs AS SELECT * FROM twice;"
      "INSERT INTO jobs SELECT * FROM twice; DROP TABLE twice");
  const auto salvage = admin::salvage_state(state());
  ASSERT_TRUE(salvage) << salvage.error().message;
  EXPECT_EQ(salvage->jobs, 2u);
  EXPECT_EQ(salvage->lost_jobs, 0u);
  EXPECT_TRUE(admin::check_state(state())->whole());
}

TEST_F(StateCheck, SalvageTakesTheLockOfAFolderThatHasNone) {
  fill();
  close();
  std::filesystem::remove(state() / "lock");
  ASSERT_TRUE(admin::check_state(state()));
  EXPECT_FALSE(std::filesystem::exists(state() / "lock"));
  ASSERT_TRUE(admin::salvage_state(state()));
  EXPECT_TRUE(std::filesystem::exists(state() / "lock"));
}

// As after a crash between the two steps: the log has only its new name, the database has both.
TEST_F(StateCheck, ASalvageThatWasCutShortIsUndoneAtTheNextStart) {
  fill();
  const TemporaryFolder copies;
  const auto crashed = copies.path() / "state";
  std::filesystem::copy(state(), crashed, std::filesystem::copy_options::recursive);
  const auto database = crashed / "tessera.db", log = crashed / "tessera.db-wal";
  const std::string bytes = read_file(log);
  ASSERT_FALSE(bytes.empty());
  std::filesystem::create_hard_link(database, crashed / "tessera.db.damaged-1");
  std::filesystem::rename(log, crashed / "tessera.db.damaged-1-wal");
  ASSERT_TRUE(store::undo_interrupted_replacement(database));
  EXPECT_TRUE(read_file(log) == bytes);
  EXPECT_FALSE(std::filesystem::exists(crashed / "tessera.db.damaged-1"));
  EXPECT_FALSE(std::filesystem::exists(crashed / "tessera.db.damaged-1-wal"));
  const auto salvage = admin::salvage_state(crashed);
  ASSERT_TRUE(salvage) << salvage.error().message;
  EXPECT_EQ(salvage->jobs, 2u);
  EXPECT_TRUE(read_file(salvage->set_aside.string() + "-wal") == bytes);
  EXPECT_FALSE(std::filesystem::exists(log));
  EXPECT_TRUE(admin::check_state(crashed)->whole());
}

TEST_F(StateCheck, ASalvageThatCannotReplaceLeavesEverythingWhereItWas) {
  fill();
  close();
  const auto database = state() / "tessera.db", log = state() / "tessera.db-wal";
  write_file(log, std::string(10, 'l'));
  const std::string before = read_file(database);
  EXPECT_FALSE(store::replace_database(database, state() / "there is no copy"));
  EXPECT_TRUE(read_file(database) == before);
  EXPECT_EQ(read_file(log), std::string(10, 'l'));
  EXPECT_FALSE(std::filesystem::exists(state() / "tessera.db.damaged-1"));
  EXPECT_FALSE(std::filesystem::exists(state() / "tessera.db.damaged-1-wal"));
}

TEST_F(StateCheck, AMissingDatabaseIsNotCreated) {
  fill();
  close();
  std::filesystem::remove(state() / "tessera.db");
  const auto opened = store::StateDirectory::open(state());
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(opened.error().message, HasSubstr("tessera.db is missing or empty"));
}

}  // namespace
}  // namespace tessera::server
