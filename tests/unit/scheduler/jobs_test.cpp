// SPDX-License-Identifier: Apache-2.0
// The lifecycle of jobs, and how they share the farm.
#include <map>

#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using core::ErrorCode;
using testing::ElementsAre;
using enum JobState;

using Jobs = Farm;
using JobsInSmallLeases = FarmOfSmallLeases;

TEST_F(Jobs, AreRenderedWholeByOneWorker) {
  submit("job", {200, 130, 13});
  render_all("w");
  EXPECT_EQ(state("job"), kDone);
  EXPECT_EQ(job("job").samples_done, 200u * 130 * 13);
}

TEST_F(JobsInSmallLeases, OfHigherPriorityAreServedFirst) {
  submit("low", tiles(100, 4), -1);
  submit("high", tiles(2, 1), 7);
  EXPECT_EQ(lease_to("a").job, JobId{"high"});
  EXPECT_EQ(lease_to("b").job, JobId{"high"});
  EXPECT_EQ(lease_to("c").job, JobId{"low"});
}

TEST_F(Jobs, OfEqualPriorityShareTheFarm) {
  submit("first", tiles(1000, 16));
  submit("second", tiles(1000, 16));
  std::map<std::string, int> leases;
  for (int w = 0; w < 10; ++w) ++leases[lease_to("w" + std::to_string(w)).job.value];
  EXPECT_EQ(leases["first"], 5);
  EXPECT_EQ(leases["second"], 5);
}

TEST_F(Jobs, OfEqualPriorityShareASingleWorker) {
  submit("first", tiles(1000, 16));
  submit("second", tiles(1000, 16));
  std::map<std::string, int> leases;
  for (int i = 0; i < 10; ++i) {
    const LeaseDescription lease = lease_to("w");
    ++leases[lease.job.value];
    deliver("w", lease);
  }
  EXPECT_EQ(leases["first"], 5);
  EXPECT_EQ(leases["second"], 5);
}

TEST_F(Jobs, ShareByTheWorkTheyCauseNotByTheirSamples) {
  submit("costly", tiles(4000, 64));
  submit("cheap", tiles(4000, 64));
  const auto deliver_at = [&](const LeaseDescription& lease) {
    std::uint64_t samples = 0;
    for (const WorkItem& item : lease.items) samples += item.samples.count() * kTilePixels;
    deliver("w", lease, lease.items, true,
            static_cast<double>(samples) / (lease.job.value == "cheap" ? 40'000 : 4'000));
  };
  for (int i = 0; i < 20; ++i) deliver_at(lease_to("w"));
  // With both in progress at once, each has about two seconds of work: ten times as many samples of the cheap
  // one.
  std::map<std::string, std::uint64_t> samples;
  for (const LeaseDescription& lease : sync("w", {}, 2).leases) {
    for (const WorkItem& item : lease.items) samples[lease.job.value] += item.samples.count();
  }
  EXPECT_EQ(samples["costly"], 2u);
  EXPECT_EQ(samples["cheap"], 20u);
}

TEST_F(Jobs, CostTheSameWhicheverMachinesServeThem) {
  submit("a", tiles(4000, 64));
  const auto serve = [&](const std::string& worker, double samples_per_second) {
    const LeaseDescription lease = lease_to(worker);
    std::uint64_t samples = 0;
    for (const WorkItem& item : lease.items) samples += item.samples.count() * kTilePixels;
    deliver(worker, lease, lease.items, true, static_cast<double>(samples) / samples_per_second);
    return lease.job.value;
  };
  serve("fast", 400'000);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(serve("slow", 4'000), "a");
  submit("b", tiles(4000, 64), 1);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(serve("fast", 400'000), "b");
  handle(UpdateJob{{"b"}, 0, {}});
  std::map<std::string, int> leases;
  for (int i = 0; i < 20; ++i) ++leases[serve("fast", 400'000)];
  EXPECT_NEAR(leases["a"], 10, 1);
}

TEST_F(Jobs, ArePausedAndResumed) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("w");
  EXPECT_THAT(handle(PauseJob{{"job"}}).job_changes, ElementsAre(JobChange{{"job"}, kRunning, kPaused}));
  EXPECT_EQ(sync("w", {lease}, 2).leases, std::vector{lease}) << "keeps what it has, is given nothing new";
  EXPECT_TRUE(sync("other").leases.empty());
  EXPECT_THAT(handle(ResumeJob{{"job"}}).job_changes, ElementsAre(JobChange{{"job"}, kPaused, kRunning}));
  EXPECT_EQ(sync("w", {lease}, 2).leases.size(), 2u);
}

TEST_F(Jobs, AreNotCopiedWhilePaused) {
  submit("job", tiles(2, 1));
  lease_to("a"), lease_to("b");
  handle(PauseJob{{"job"}});
  EXPECT_TRUE(sync("c").leases.empty());
}

TEST_F(Jobs, WhoseLastSamplesCameInWhilePausedAreDoneWhenResumed) {
  submit("job", tiles(2, 1));
  const LeaseDescription a = lease_to("a"), b = lease_to("b");
  handle(PauseJob{{"job"}});
  deliver("a", a), deliver("b", b);
  EXPECT_EQ(state("job"), kPaused);
  EXPECT_THAT(handle(ResumeJob{{"job"}}).job_changes,
              ElementsAre(JobChange{{"job"}, kPaused, kRunning}, JobChange{{"job"}, kRunning, kDone}));
}

TEST_F(Jobs, RenderATileAgainThatTheirFilmHasLost) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  deliver("w", lease);
  const std::uint64_t before = job("job").samples_done;
  const int tile = lease.items.front().tile;
  EXPECT_THAT(handle(DropTile{{"job"}, tile}).dropped_tiles, ElementsAre(TileOfJob{{"job"}, tile}));
  EXPECT_LT(job("job").samples_done, before);
  render_all("w");
  EXPECT_EQ(state("job"), kDone);
  EXPECT_THAT(handle(DropTile{{"job"}, tile}).job_changes, ElementsAre(JobChange{{"job"}, kDone, kRunning}));
  render_all("w");
  EXPECT_EQ(state("job"), kDone);
  submit("cancelled", tiles(2, 4));
  handle(CancelJob{{"cancelled"}});
  EXPECT_TRUE(handle(DropTile{{"cancelled"}, 0}).dropped_tiles.empty());
}

TEST_F(Jobs, ThatAreCancelledAreTakenFromTheirWorkers) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("w");
  EXPECT_THAT(handle(CancelJob{{"job"}}).job_changes, ElementsAre(JobChange{{"job"}, kRunning, kCancelled}));
  const Reply reply = sync("w", {lease});
  EXPECT_TRUE(reply.leases.empty());
  EXPECT_TRUE(reply.changed);
}

TEST_F(Jobs, ThatFailSayWhyAndLeaveOthersAlone) {
  submit("bad", tiles(100, 4));
  submit("good", tiles(2, 1));
  lease_to("w");
  EXPECT_THAT(handle(FailJob{{"bad"}, "wood.png is not an image"}).job_changes,
              ElementsAre(JobChange{{"bad"}, kRunning, kFailed}));
  EXPECT_EQ(job("bad").failure, "wood.png is not an image");
  render_all("w");
  EXPECT_EQ(state("good"), kDone);
}

TEST_F(Jobs, KeepTheFirstReasonForFailing) {
  submit("job", tiles(2, 1));
  handle(FailJob{{"job"}, "first"});
  EXPECT_TRUE(handle(FailJob{{"job"}, "second"}).status);
  EXPECT_EQ(job("job").failure, "first");
}

TEST_F(Jobs, ThatAreDeletedAreGone) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("w");
  EXPECT_TRUE(handle(DeleteJob{{"job"}}).status);
  EXPECT_TRUE(sync("w", {lease}).leases.empty());
  EXPECT_FALSE(scheduler_->job({"job"}, now_));
  EXPECT_EQ(handle(DeleteJob{{"job"}}).status.error().code, ErrorCode::kNotFound);
}

TEST_F(Jobs, ThatAreFinishedCanLeaveWithoutAChange) {
  submit("job", tiles(4, 1));
  const LeaseDescription late = lease_to("late");
  EXPECT_EQ(handle(ReleaseJob{{"job"}}).status.error().code, ErrorCode::kFailedPrecondition);
  handle(PauseJob{{"job"}});
  EXPECT_EQ(handle(ReleaseJob{{"job"}}).status.error().code, ErrorCode::kFailedPrecondition);
  handle(CancelJob{{"job"}});
  const Actions released = handle(ReleaseJob{{"job"}});
  EXPECT_TRUE(released.status);
  EXPECT_THAT(released.job_changes, testing::IsEmpty());
  EXPECT_THAT(released.changed_jobs, testing::IsEmpty());
  EXPECT_FALSE(scheduler_->job({"job"}, now_));
  EXPECT_TRUE(sync("late", {late}).leases.empty());
  EXPECT_EQ(handle(ReleaseJob{{"job"}}).status.error().code, ErrorCode::kNotFound);
  submit("job", tiles(4, 1));
  render_all("w");
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(JobsInSmallLeases, CanBeExtendedWhileTheyRun) {
  submit("job", tiles(4, 3));
  for (int i = 0; i < 5; ++i) deliver("w", lease_to("w"));
  EXPECT_TRUE(handle(ExtendJob{{"job"}, 21}).status);
  render_all("w");
  EXPECT_EQ(job("job").samples_done, 4 * kTilePixels * 21);
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Jobs, ThatAreDoneRunAgainWhenExtended) {
  submit("job", tiles(4, 3));
  render_all("w");
  EXPECT_THAT(handle(ExtendJob{{"job"}, 21}).job_changes, ElementsAre(JobChange{{"job"}, kDone, kRunning}));
  render_all("w");
  EXPECT_EQ(job("job").samples_done, 4 * kTilePixels * 21);
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Jobs, StayPausedWhenExtended) {
  submit("job", tiles(4, 3));
  handle(PauseJob{{"job"}});
  handle(ExtendJob{{"job"}, 21});
  EXPECT_EQ(state("job"), kPaused);
}

TEST_F(Jobs, NeverShrink) {
  submit("job", tiles(4, 3));
  EXPECT_EQ(handle(ExtendJob{{"job"}, 2}).status.error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(handle(ExtendJob{{"job"}, 3}).status);
  EXPECT_EQ(job("job").shape.spp, 3u);
}

TEST_F(Jobs, RefuseWhatTheirStateDoesNotAllow) {
  for (const char* id : {"done", "cancelled"}) submit(id, tiles(2, 1));
  handle(CancelJob{{"cancelled"}});
  render_all("w");
  for (const Event& event :
       {Event{PauseJob{{"done"}}}, Event{ResumeJob{{"done"}}}, Event{CancelJob{{"done"}}},
        Event{FailJob{{"done"}, "x"}}, Event{PauseJob{{"cancelled"}}}, Event{ResumeJob{{"cancelled"}}},
        Event{ExtendJob{{"cancelled"}, 9}}}) {
    const Actions actions = handle(event);
    ASSERT_FALSE(actions.status) << event.index();
    EXPECT_EQ(actions.status.error().code, ErrorCode::kFailedPrecondition);
    EXPECT_TRUE(actions.job_changes.empty());
  }
  EXPECT_EQ(state("done"), kDone);
  EXPECT_EQ(job("done").failure, "");
  EXPECT_EQ(state("cancelled"), kCancelled);
}

TEST_F(Jobs, ChangesAreIdempotent) {
  submit("job", tiles(2, 1));
  for (const Event& event : {Event{ResumeJob{{"job"}}}, Event{PauseJob{{"job"}}}, Event{PauseJob{{"job"}}},
                             Event{CancelJob{{"job"}}}, Event{CancelJob{{"job"}}}}) {
    EXPECT_TRUE(handle(event).status) << event.index();
  }
}

TEST_F(Jobs, MustExistToBeDirected) {
  for (const Event& event :
       {Event{PauseJob{{"none"}}}, Event{ResumeJob{{"none"}}}, Event{CancelJob{{"none"}}},
        Event{DeleteJob{{"none"}}}, Event{ExtendJob{{"none"}, 9}}, Event{FailJob{{"none"}, "x"}}}) {
    EXPECT_EQ(handle(event).status.error().code, ErrorCode::kNotFound) << event.index();
  }
}

TEST_F(Jobs, MustHaveSomethingToRenderAndAnIdOfTheirOwn) {
  for (const JobShape& shape : {JobShape{0, 1, 1}, JobShape{1, -1, 1}, JobShape{1, 1, 0}}) {
    EXPECT_EQ(handle(SubmitJob{{"job"}, shape, 0}).status.error().code, ErrorCode::kInvalidArgument);
  }
  submit("job", {1, 1, 1});
  EXPECT_EQ(handle(SubmitJob{{"job"}, {1, 1, 1}, 0}).status.error().code, ErrorCode::kAlreadyExists);
  EXPECT_EQ(scheduler_->jobs(now_).size(), 1u);
}

TEST_F(Jobs, ShowTheirSpeed) {
  submit("job", tiles(1000, 16));
  for (int i = 0; i < 20; ++i) {
    const LeaseDescription lease = lease_to("w");
    pass(seconds(1));
    deliver("w", lease, {lease.items[0]});
  }
  EXPECT_NEAR(job("job").samples_per_second, kTilePixels, kTilePixels * 0.2);
  EXPECT_NEAR(scheduler_->workers(now_)[0].samples_per_second, kTilePixels, kTilePixels * 0.2);
  handle(CancelJob{{"job"}});
  EXPECT_EQ(job("job").samples_per_second, 0);
}

TEST_F(Jobs, OfAWindowAreRenderedWhole) {
  submit("job", {{70, 10, 270, 140}, 13});
  EXPECT_EQ(job("job").samples_total, 200u * 130 * 13);
  render_all("w");
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(JobsInSmallLeases, CanBeGivenAnotherPriority) {
  submit("a", tiles(100, 4), 1);
  submit("b", tiles(100, 4));
  EXPECT_EQ(lease_to("v").job, JobId{"a"});
  ASSERT_TRUE(handle(UpdateJob{{"b"}, 2, {}}).status);
  EXPECT_EQ(job("b").priority, 2);
  EXPECT_EQ(lease_to("w").job, JobId{"b"});
  ASSERT_TRUE(handle(UpdateJob{{"b"}, -5, {}}).status);
  EXPECT_EQ(lease_to("x").job, JobId{"a"});
}

TEST_F(Jobs, KeepWhatAnUpdateDoesNotName) {
  submit("job", tiles(2, 1), 3, 4);
  ASSERT_TRUE(handle(UpdateJob{{"job"}, {}, {}}).status);
  EXPECT_EQ(job("job").priority, 3);
  EXPECT_EQ(job("job").max_workers, 4u);
  ASSERT_TRUE(handle(UpdateJob{{"job"}, {}, 0}).status);
  EXPECT_EQ(job("job").priority, 3);
  EXPECT_EQ(job("job").max_workers, 0u);
}

TEST_F(Jobs, CanBeUpdatedWhileTheyArePausedButNotWhenTheyAreOver) {
  submit("job", tiles(2, 1));
  handle(PauseJob{{"job"}});
  EXPECT_TRUE(handle(UpdateJob{{"job"}, 1, {}}).status);
  handle(CancelJob{{"job"}});
  submit("done", tiles(2, 1));
  render_all("w");
  for (const char* over : {"job", "done"}) {
    EXPECT_EQ(handle(UpdateJob{{over}, 2, 2}).status.error().code, ErrorCode::kFailedPrecondition);
    EXPECT_LT(job(over).priority, 2);
    EXPECT_EQ(job(over).max_workers, 0u);
  }
  EXPECT_EQ(handle(UpdateJob{{"none"}, 2, 2}).status.error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace tessera::scheduler
