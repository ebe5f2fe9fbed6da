// SPDX-License-Identifier: Apache-2.0
// The state of a coordinator after a stop and after a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <functional>

#include "server/farm/stored_job.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

class Restart : public ScriptedFarm {
 protected:
  // Opens a coordinator on a copy of the current files on disk, as after kill -9.
  void crash() {
    const auto crashed = folder_.path() / "crashed" / std::to_string(++crashes_);
    std::filesystem::create_directories(crashed.parent_path());
    std::filesystem::copy(folder_.path() / "state", crashed, std::filesystem::copy_options::recursive);
    open(crashed);
  }

  void meddle(const std::string& sql) {
    coordinator_.reset();
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((folder_.path() / "state" / "tessera.db").c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }

  // Changes jobs' rows as an earlier run of the coordinator might have left them.
  void rewrite_jobs(const std::function<void(store::JobRow&)>& change) {
    coordinator_.reset();
    auto store = store::JobStore::open(folder_.path() / "state" / "tessera.db");
    const auto rows = store->jobs();
    for (store::JobRow row : *rows) {
      row.settled = false;
      change(row);
      ++row.revision;
      EXPECT_TRUE(store->update_job(row));
    }
  }

  int crashes_ = 0;
};

TEST_F(Restart, AStateThatIsRemovedMeanwhileIsMissedByTheNextCheckpoint) {
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  std::filesystem::rename(folder_.path() / "state", folder_.path() / "away");
  const auto missed = coordinator().checkpointer().checkpoint();
  ASSERT_FALSE(missed);
  EXPECT_THAT(missed.error().message, HasSubstr("was removed while the coordinator runs"));
  std::filesystem::rename(folder_.path() / "away", folder_.path() / "state");
  EXPECT_TRUE(coordinator().checkpointer().checkpoint());
}

// Labels are encoded in any order.
TEST_F(Restart, FindsJobsOfManyLabelsUndamaged) {
  v1::SubmitJobRequest request = submission();
  for (const char* key : {"shot", "show", "artist", "scene", "take", "client", "pass", "camera"})
    (*request.mutable_labels())[key] = "7";
  const std::string id = submit(request);
  for (int i = 0; i < 5; ++i) {
    work('a', 1);
    ASSERT_TRUE(coordinator().checkpointer().checkpoint());
    open();
    ASSERT_EQ(job(id).state(), v1::JOB_STATE_RUNNING) << job(id).failure();
    EXPECT_EQ(job(id).labels_size(), 8);
  }
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
}

TEST_F(Restart, CarriesOnFromTheCheckpointToTheSameImage) {
  const std::string id = submit();
  work('a', 3);
  const v1::Job before = job(id);
  const core::Image so_far = coordinator().images().get(id)->image;
  ASSERT_GT(before.samples_done(), 0u);
  ASSERT_LT(before.samples_done(), kSamples);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  EXPECT_EQ(job(id).samples_done(), before.samples_done());
  EXPECT_EQ(job(id).counters().SerializeAsString(), before.counters().SerializeAsString());
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, so_far.pixels);
  work('b');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Restart, ACrashCostsWhatCameAfterTheCheckpointAndNothingElse) {
  const std::string id = submit();
  work('a', 2);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  const std::uint64_t stored = job(id).samples_done();
  work('a', 2);
  ASSERT_GT(job(id).samples_done(), stored);
  crash();
  EXPECT_EQ(job(id).samples_done(), stored);
  work('b');
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Restart, AnAcceptedJobSurvivesACrashAtOnce) {
  const std::string id = submit();
  crash();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
}

TEST_F(Restart, AcknowledgedChangesSurviveACrashAtOnce) {
  const std::string paused = submit(), cancelled = submit(), extended = submit(), deleted = submit();
  ASSERT_TRUE(coordinator().jobs().pause(paused));
  ASSERT_TRUE(coordinator().jobs().cancel(cancelled));
  ASSERT_TRUE(coordinator().jobs().extend(extended, 100));
  ASSERT_TRUE(coordinator().jobs().remove(deleted));
  crash();
  EXPECT_EQ(job(paused).state(), v1::JOB_STATE_PAUSED);
  EXPECT_EQ(job(cancelled).state(), v1::JOB_STATE_CANCELLED);
  EXPECT_EQ(job(extended).settings().spp(), 100u);
  EXPECT_EQ(coordinator().jobs().get(deleted).error().code, ErrorCode::kNotFound);
}

TEST_F(Restart, AResultOfALeaseFromBeforeCountsAfterwards) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  crash();
  EXPECT_EQ(deliver(delivery('a', lease)).accepted_items(), static_cast<std::uint32_t>(lease.items_size()));
  work('b');
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Restart, LeaseNumbersAreNeverUsedAgain) {
  submit();
  const std::uint64_t before = synchronize(greeting('a')).leases(0).id();
  crash();
  EXPECT_NE(synchronize(greeting('a')).leases(0).id(), before);
}

TEST_F(Restart, ADoneJobStaysDoneWithItsImageTimeAndCounters) {
  const std::string id = submit();
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  const v1::Job before = job(id);
  open();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(job(id).finished_at().SerializeAsString(), before.finished_at().SerializeAsString());
  EXPECT_EQ(job(id).counters().SerializeAsString(), before.counters().SerializeAsString());
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Restart, ACompletionIsPublishedOnceItIsDurable) {
  const std::string id = submit();
  EXPECT_FALSE(coordinator().dispatcher().tick());
  work('a');
  EXPECT_EQ(job(id).samples_done(), kSamples);
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  EXPECT_FALSE(job(id).has_finished_at());
  EXPECT_TRUE(coordinator().dispatcher().tick()) << "nobody is asked for a checkpoint";
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  EXPECT_FALSE(coordinator().dispatcher().tick());
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(job(id).has_finished_at());
  crash();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
}

TEST_F(Restart, AJobThatWasDoneButNotStoredAsSuchIsDone) {
  const std::string id = submit();
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  rewrite_jobs([](store::JobRow& row) {  // tiles were written, but not the row
    row.state = v1::JOB_STATE_RUNNING;
    row.finished_ms.reset();
  });
  open();
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
}

TEST_F(Restart, SamplesBeyondTheStoredNumberShowThatTheJobWasExtended) {
  const std::string id = submit();
  ASSERT_TRUE(coordinator().jobs().extend(id, kSpp + 4));
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  rewrite_jobs([](store::JobRow& row) {
    row.spp = kSpp;
    row.state = v1::JOB_STATE_RUNNING;
  });
  open();
  EXPECT_EQ(job(id).settings().spp(), kSpp + 4);
}

TEST_F(Restart, ADamagedTileOfARunningJobIsRenderedAgain) {
  const std::string id = submit();
  work('a', 3);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  const std::uint64_t stored = job(id).samples_done();
  meddle("UPDATE tiles SET content = X'00' WHERE tile = 0");
  open();
  EXPECT_LT(job(id).samples_done(), stored);
  work('b');
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Restart, ADamagedJobFailsAndAffectsNoOther) {
  const std::string damaged = submit(), whole = submit();
  work('a', 2);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  meddle("UPDATE jobs SET spec = X'ff' WHERE id = '" + damaged + "'");
  open();
  EXPECT_EQ(job(damaged).state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(job(damaged).failure(), HasSubstr("the stored job " + damaged + " is damaged: delete it"));
  work('b');
  EXPECT_EQ(stored_job(whole).state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(coordinator().jobs().remove(damaged));
}

TEST_F(Restart, AJobWithAnImpossibleRowFailsAndAffectsNoOther) {
  const std::string damaged = submit(), whole = submit();
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  const std::pair<std::uint32_t, int> impossible[] = {{0, 1}, {16'777'217, 1}, {kSpp, 0}, {kSpp, 99}};
  for (const auto& [spp, state] : impossible) {
    const auto rewrite = [&](std::uint32_t new_spp, int new_state) {
      rewrite_jobs([&](store::JobRow& row) {
        if (row.id != damaged) return;
        row.spp = new_spp;
        row.state = new_state;
      });
    };
    rewrite(spp, state);
    open();
    EXPECT_EQ(job(damaged).state(), v1::JOB_STATE_FAILED) << spp << ' ' << state;
    EXPECT_EQ(job(whole).state(), v1::JOB_STATE_RUNNING) << spp << ' ' << state;
    rewrite(kSpp, v1::JOB_STATE_RUNNING);
  }
}

// With valid checksums, but values that no coordinator writes.
TEST_F(Restart, ForeignRowsFailTheirJobsAndAffectNoOther) {
  const std::string damaged = submit(), whole = submit(), mute = submit(), huge = submit(),
                    timeless = submit();
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  rewrite_jobs([&](store::JobRow& row) {
    if (row.id == mute) row.failure = "no \xff text";
  });
  {
    auto store = store::JobStore::open(folder_.path() / "state" / "tessera.db");
    auto rows = store->jobs().value();
    const auto row_of = [&](const std::string& id) -> store::JobRow& {
      return *std::find_if(rows.begin(), rows.end(), [&](const store::JobRow& row) { return row.id == id; });
    };
    row_of(damaged).spec = row_of(whole).spec;
    v1::Job spec;
    ASSERT_TRUE(farm::decode_spec(row_of(huge).spec, spec));
    spec.mutable_settings()->set_width_px(65536);
    spec.mutable_settings()->set_height_px(16384);
    row_of(huge).spec = farm::encode_spec(spec);
    row_of(timeless).created_ms = INT64_MIN;
    row_of(timeless).finished_ms = INT64_MAX;
    for (const std::string& id : {damaged, huge, timeless})
      ASSERT_TRUE(store->delete_job(id) && store->insert_job(row_of(id)));
  }
  open();
  EXPECT_EQ(job(damaged).state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(job(mute).failure(), HasSubstr("is damaged: delete it"));
  EXPECT_THAT(job(huge).failure(), HasSubstr("65536 x 16384"));
  EXPECT_THAT(job(timeless).failure(), HasSubstr("is damaged: delete it"));
  EXPECT_EQ(job(whole).state(), v1::JOB_STATE_RUNNING);
}

TEST_F(Restart, AJobWithABinaryNameIsLeftOutAndAffectsNoOther) {
  const std::string damaged = submit(), whole = submit();
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  meddle("UPDATE jobs SET id = CAST(X'6AFF' AS TEXT) WHERE id = '" + damaged + "'");
  open();
  const auto listed = coordinator().jobs().list();
  ASSERT_TRUE(listed) << listed.error().message;
  ASSERT_EQ(listed->jobs_size(), 1);
  EXPECT_EQ(listed->jobs(0).id(), whole);
  EXPECT_EQ(listed->jobs(0).state(), v1::JOB_STATE_RUNNING);
  EXPECT_TRUE(coordinator().checkpointer().checkpoint());
}

// One bit of a seed would give another image.
TEST_F(Restart, AJobWithAChangedRowFailsAndAffectsNoOther) {
  const std::string damaged = submit(), whole = submit();
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  meddle("UPDATE jobs SET spp = 7 WHERE id = '" + damaged + "'");
  open();
  EXPECT_EQ(job(damaged).state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(job(damaged).failure(), HasSubstr("the stored job " + damaged + " is damaged: delete it"));
  EXPECT_EQ(job(whole).state(), v1::JOB_STATE_RUNNING);
}

// [0, 4096) instead of the samples that are done.
constexpr const char* kTooManySamples = "UPDATE tiles SET done = X'0000000000100000' WHERE tile = 0";

TEST_F(Restart, ADamagedRowDoesNotRaiseARunningJobsSamples) {
  const std::string id = submit();
  work('a', 3);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  meddle(kTooManySamples);
  open();
  EXPECT_EQ(job(id).settings().spp(), kSpp);
  work('b');
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Restart, ADamagedRowDoesNotRaiseAFinishedJobsSamples) {
  const std::string id = submit();
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  for (const v1::JobState state : {v1::JOB_STATE_DONE, v1::JOB_STATE_CANCELLED}) {
    rewrite_jobs([&](store::JobRow& row) { row.state = state; });
    meddle(kTooManySamples);
    open();
    EXPECT_EQ(job(id).state(), state);
    EXPECT_EQ(job(id).settings().spp(), kSpp);
    EXPECT_EQ(coordinator().images().get(id).error().code, ErrorCode::kDataLoss);
  }
}

TEST_F(Restart, ADoneJobThatLacksATileRendersIt) {
  const std::string id = submit();
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  meddle("DELETE FROM tiles WHERE tile = 2; UPDATE jobs SET settled = 0");  // as --salvage leaves it
  open();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  work('b');
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Restart, ADamagedTileOfADoneJobIsReportedAndAffectsNoOther) {
  const std::string damaged = submit(), whole = submit();
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  meddle("UPDATE tiles SET content = X'00' WHERE tile = 0 AND job_id = '" + damaged + "'");
  open();
  const auto image = coordinator().images().get(damaged);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(image.error().message, HasSubstr("tile 0 of job " + damaged + " is damaged"));
  EXPECT_EQ(coordinator().jobs().extend(damaged, kSpp + 1).error().code, ErrorCode::kDataLoss);
  EXPECT_TRUE(coordinator().images().get(whole));
}

TEST_F(Restart, ACheckpointThatCouldNotBeWrittenIsTriedAgain) {
  const std::string id = submit();
  work('a', 2);
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open((folder_.path() / "state" / "tessera.db").c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_EQ(coordinator().checkpointer().checkpoint().error().code, ErrorCode::kUnavailable);
  sqlite3_close(other);
  const std::uint64_t done = job(id).samples_done();
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  crash();
  EXPECT_EQ(job(id).samples_done(), done);
}

}  // namespace
}  // namespace tessera::server
