// SPDX-License-Identifier: Apache-2.0
// Whoever follows a farm by WatchFarm knows what ListJobs and ListWorkers return.
#include "server/watch/farm_feed.hpp"

#include <gmock/gmock.h>

#include <map>
#include <string>

#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

// What somebody has learned from a stream.
class Follower {
 public:
  explicit Follower(watch::FarmFeed& feed) : feed_(&feed) {}

  void connect(watch::FarmFeed& feed) { feed_ = &feed; }
  // Reads everything there is. Returns the number of messages that were not empty.
  int catch_up() {
    int messages = 0;
    for (;;) {
      const auto update = feed_->after(watch::from_token(token_)).value();
      if (update->is_empty()) return messages;
      ++messages;
      apply(update->message);
      if (!feed_->has_changes_after(update->next)) return messages;
    }
  }

  std::map<std::string, v1::Job> jobs;
  std::map<std::string, v1::Worker> workers;
  int resets = 0;

 private:
  void apply(const v1::WatchFarmResponse& message) {
    if (message.reset()) {
      ++resets;
      jobs.clear();
      workers.clear();
    }
    for (const v1::Job& job : message.jobs()) jobs[job.id()] = job;
    for (const v1::Worker& worker : message.workers()) workers[worker.id()] = worker;
    for (const std::string& id : message.deleted_job_ids()) jobs.erase(id);
    for (const std::string& id : message.removed_worker_ids()) workers.erase(id);
    token_ = message.resume_token();
  }

  watch::FarmFeed* feed_;
  std::string token_;
};

class FarmFeed : public ScriptedFarm {
 protected:
  FarmFeed() : follower_(coordinator().farm_feed()) {}

  // The follower knows what there is to know, but for what only time changes.
  void expect_current() {
    follower_.catch_up();
    std::map<std::string, v1::Job> jobs;
    for (const v1::Job& job : listed()) jobs[job.id()] = job;
    ASSERT_EQ(follower_.jobs.size(), jobs.size());
    for (auto& [id, job] : jobs) {
      v1::Job known = follower_.jobs[id];
      known.clear_samples_per_second();
      job.clear_samples_per_second();
      EXPECT_EQ(known.DebugString(), job.DebugString());
    }
    const auto workers = coordinator().dispatcher().workers();
    ASSERT_EQ(follower_.workers.size(), workers.size());
    for (v1::Worker worker : workers) {
      v1::Worker known = follower_.workers[worker.id()];
      for (v1::Worker* each : {&known, &worker}) {
        each->clear_samples_per_second();
        each->clear_last_seen_at();
      }
      EXPECT_EQ(known.DebugString(), worker.DebugString());
    }
  }

  Follower follower_;
};

TEST_F(FarmFeed, FollowsAJobThroughItsLife) {
  expect_current();
  const std::string id = submit();
  expect_current();
  EXPECT_THAT(follower_.jobs, SizeIs(1));
  work('a', 1);
  expect_current();
  ASSERT_TRUE(coordinator().jobs().pause(id));
  expect_current();
  v1::UpdateJobRequest change;
  change.set_job_id(id);
  change.set_priority(3);
  ASSERT_TRUE(coordinator().jobs().update(change));
  expect_current();
  ASSERT_TRUE(coordinator().jobs().resume(id));
  work('a');
  expect_current();
  EXPECT_EQ(follower_.jobs[id].state(), v1::JOB_STATE_RUNNING) << "it is not stored yet";
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  expect_current();
  EXPECT_EQ(follower_.jobs[id].state(), v1::JOB_STATE_DONE);
  ASSERT_TRUE(coordinator().jobs().extend(id, kSpp + 2));
  expect_current();
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  expect_current();
  ASSERT_TRUE(coordinator().jobs().remove(id));
  expect_current();
  EXPECT_THAT(follower_.jobs, IsEmpty());
  EXPECT_EQ(follower_.resets, 1);
}

TEST_F(FarmFeed, FollowsWorkersThroughTheirLives) {
  submit();
  synchronize(greeting('a'));
  const WaitingCall b(coordinator(), greeting('b'));
  expect_current();
  EXPECT_THAT(follower_.workers, SizeIs(2));
  v1::SynchronizeRequest troubled = greeting('a');
  troubled.add_troubles()->set_text("the disk is full");
  const WaitingCall with_troubles(coordinator(), troubled);
  expect_current();
  const WaitingCall without(coordinator(), greeting('a'));
  expect_current();
  v1::SynchronizeRequest leaving = greeting('b');
  leaving.set_draining(true);
  const WaitingCall draining(coordinator(), leaving);
  expect_current();
  now_ += std::chrono::seconds(11);
  coordinator().dispatcher().tick();
  expect_current();
  EXPECT_TRUE(follower_.workers[std::string(32, 'a')].silent());
  now_ += std::chrono::seconds(200);
  coordinator().dispatcher().tick();
  expect_current();
  EXPECT_THAT(follower_.workers, IsEmpty());
}

TEST_F(FarmFeed, NamesAQuarantinedWorker) {
  submit();
  v1::SynchronizeResponse given = synchronize(greeting('a'));
  for (int i = 0; i < 3; ++i) {
    v1::SubmitResultRequest wrong = delivery('a', given.leases(0));
    wrong.mutable_items(0)->set_sums_xxh3(i);
    EXPECT_FALSE(coordinator().dispatcher().submit_result(wrong));
    expect_current();
  }
  EXPECT_TRUE(follower_.workers[std::string(32, 'a')].quarantined());
}

TEST_F(FarmFeed, RestartsAfterARestart) {
  const std::string kept = submit(), deleted = submit();
  work('a', 1);
  expect_current();
  open();
  ASSERT_TRUE(coordinator().jobs().remove(deleted));
  follower_.connect(coordinator().farm_feed());
  expect_current();
  EXPECT_EQ(follower_.resets, 2);
  EXPECT_THAT(follower_.workers, IsEmpty());
  EXPECT_THAT(follower_.jobs, SizeIs(1));
}

TEST_F(FarmFeed, IsReadInParts) {
  for (int i = 0; i < 600; ++i) submit();
  EXPECT_EQ(follower_.catch_up(), 2);
  expect_current();
  EXPECT_EQ(follower_.catch_up(), 0);
}

TEST_F(FarmFeed, EncodesAMessageOnceForAllSubscribers) {
  submit();
  Follower other(coordinator().farm_feed());
  follower_.catch_up();
  const auto cursor = coordinator().farm_feed().after({}).value()->next;
  submit();
  EXPECT_EQ(coordinator().farm_feed().after(cursor).value(), coordinator().farm_feed().after(cursor).value());
}

// It is sent what was read for another one, which has become incomplete meanwhile.
TEST_F(FarmFeed, ASlowSubscriberMissesNothing) {
  Follower slow(coordinator().farm_feed());
  follower_.catch_up();
  slow.catch_up();
  submit();
  follower_.catch_up();
  submit();
  slow.catch_up();
  EXPECT_THAT(slow.jobs, SizeIs(2));
  EXPECT_EQ(slow.catch_up(), 0);
}

TEST(FarmToken, IsReadBack) {
  const events::Cursor cursor{0x0123456789abcdef, 0xfedcba9876543210};
  EXPECT_EQ(watch::from_token(watch::to_token(cursor)), cursor);
  for (const char* const token : {"", "x", "fifteen letters", "seventeen letters"})
    EXPECT_EQ(watch::from_token(token), events::Cursor()) << token;
}

}  // namespace
}  // namespace tessera::server
