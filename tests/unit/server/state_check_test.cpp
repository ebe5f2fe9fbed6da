#include "server/coordinator/state_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::coordinator {
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
  // A job that is done and one that is under way, stored.
  void fill() {
    done_ = submit();
    work('a');
    running_ = submit();
    work('b', 3);
    ASSERT_TRUE(coordinator().checkpoint());
  }

  std::string done_, running_;
};

TEST_F(StateCheck, FindsNothingWrongWithASoundState) {
  fill();
  const std::uint64_t samples = job(running_).samples_done();
  ASSERT_EQ(check_state(state()).error().code, ErrorCode::kFailedPrecondition) << "a coordinator runs on it";
  close();
  const auto findings = check_state(state());
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
  const auto tiles = check_state(state());
  ASSERT_TRUE(tiles);
  EXPECT_FALSE(tiles->whole());
  EXPECT_THAT(tiles->jobs[0].damage, ElementsAre(AllOf(HasSubstr("tile 1"), HasSubstr("--salvage"))));
  EXPECT_THAT(tiles->jobs[1].damage, ElementsAre(AllOf(HasSubstr("tile 1"), HasSubstr("rendered again"))));

  meddle("UPDATE jobs SET spp = 5 WHERE id = '" + done_ + "'");
  EXPECT_THAT(check_state(state())->jobs[0].damage,
              ElementsAre(HasSubstr("the stored job " + done_ + " is damaged")));

  const auto blob = store::BlobStore::look_at(state() / "blobs").path(proto::digest_of(kSceneBytes));
  write_file(blob, "[}");
  EXPECT_THAT(to_text(*check_state(state())),
              AllOf(HasSubstr(blob.string()), HasSubstr("submit the scene again")));
  std::filesystem::remove(blob);
  EXPECT_THAT(to_text(*check_state(state())), HasSubstr("is missing"));
  write_file(state() / "blobs" / "incoming" / "half", "x");
  EXPECT_THAT(check_state(state())->notes, ElementsAre(HasSubstr("1 interrupted upload")));
}

TEST_F(StateCheck, IsForStatesOnly) {
  EXPECT_EQ(check_state(folder_.path()).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(salvage_state(folder_.path()).error().code, ErrorCode::kNotFound);
}

TEST_F(StateCheck, SalvageKeepsWhatIsWholeAndTheRestIsRenderedAgain) {
  fill();
  const std::string lost = submit();
  ASSERT_TRUE(coordinator().checkpoint());
  meddle("UPDATE tiles SET content = X'00' WHERE tile = 1; UPDATE jobs SET spp = 5 WHERE id = '" + lost +
         "'");
  const auto salvage = salvage_state(state());
  ASSERT_TRUE(salvage) << salvage.error().message;
  EXPECT_EQ(salvage->jobs, 2u);
  EXPECT_EQ(salvage->lost_jobs, 1u);
  EXPECT_EQ(salvage->lost_tiles, 2u);
  EXPECT_TRUE(std::filesystem::exists(salvage->set_aside));
  EXPECT_TRUE(check_state(state())->whole());
  open();
  EXPECT_EQ(job(done_).state(), v1::JOB_STATE_RUNNING);
  work('c');
  for (const std::string& id : {done_, running_}) {
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
    EXPECT_EQ(coordinator().picture(id)->image.pixels, ready_made_picture(kWidthPx, kHeightPx, kSpp).pixels);
  }
}

TEST_F(StateCheck, ADatabaseThatIsGoneIsNotBegunAnew) {
  fill();
  close();
  std::filesystem::remove(state() / "tessera.db");
  const auto opened = store::StateDirectory::open(state());
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(opened.error().message, HasSubstr("tessera.db is missing or empty"));
}

}  // namespace
}  // namespace tessera::coordinator
