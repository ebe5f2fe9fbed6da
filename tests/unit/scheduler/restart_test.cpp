// SPDX-License-Identifier: Apache-2.0
// A coordinator restarts with its stored state.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using enum JobState;

using Restart = Farm;

TEST_F(Restart, KeepsWhatIsDone) {
  submit("job", tiles(4, 8));
  deliver("w", lease_to("w"));
  const std::uint64_t done = job("job").samples_done;
  restart();
  EXPECT_EQ(job("job").samples_done, done);
  render_all("w");
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Restart, LetsWorkersKeepTheirLeases) {
  submit("job", tiles(100, 8));
  const LeaseDescription lease = lease_to("w");
  restart();
  const Reply reply = sync("w", {lease});
  EXPECT_EQ(reply.leases, std::vector{lease});
  EXPECT_FALSE(reply.changed);
  EXPECT_EQ(lease_to("other").items.front(), (WorkItem{4, {0, 1}}));
}

TEST_F(Restart, LetsWorkersKeepOnlyWhatIsStillMissing) {
  submit("job", tiles(100, 8));
  const LeaseDescription lease = lease_to("w");
  deliver("stranger", {LeaseId{1}, {"job"}, {lease.items[1]}});
  restart();
  EXPECT_EQ(sync("w", {lease}).leases[0].items,
            (std::vector<WorkItem>{lease.items[0], lease.items[2], lease.items[3]}));
}

TEST_F(Restart, TakesALeaseAwayWhoseWorkWentToAnother) {
  submit("job", tiles(100, 8));
  const LeaseDescription old = lease_to("late");
  restart();
  ASSERT_EQ(lease_to("early").items, old.items);
  const Reply reply = sync("late", {old}, 0);
  EXPECT_TRUE(reply.leases.empty());
  EXPECT_TRUE(reply.changed);
}

TEST_F(Restart, TakesOverLeasesOfPausedJobsButNotOfFinishedOnes) {
  submit("paused", tiles(100, 8), 1);
  const LeaseDescription of_paused = lease_to("a");
  handle(PauseJob{{"paused"}});
  submit("cancelled", tiles(100, 8));
  const LeaseDescription of_cancelled = lease_to("b");
  handle(CancelJob{{"cancelled"}});
  restart();
  EXPECT_EQ(state("paused"), kPaused);
  EXPECT_EQ(state("cancelled"), kCancelled);
  EXPECT_EQ(sync("a", {of_paused}).leases, std::vector{of_paused});
  EXPECT_TRUE(sync("b", {of_cancelled}).leases.empty());
}

TEST_F(Restart, RendersARecoveredLeaseAgainIfItsWorkerIsLost) {
  submit("job", tiles(100, 8));
  const LeaseDescription lease = lease_to("w");
  restart();
  sync("w", {lease});
  pass(seconds(10));
  EXPECT_EQ(lease_to("other").items, std::vector{lease.items[0]});
}

TEST_F(Restart, LosesNothingOfALeaseThatReportsTheSameSamplesTwice) {
  submit("job", tiles(2, 8));
  restart();
  const LeaseDescription doubled{
      LeaseId{5}, {"job"}, {{0, {0, 4}}, {0, {2, 6}}, {kNoTile, {0, 1}}, {1, {0, 99}}}};
  EXPECT_EQ(sync("w", {doubled}).leases[0].items, (std::vector<WorkItem>{{0, {0, 4}}, {0, {4, 6}}}));
}

TEST_F(Restart, TakesALeaseOverOnceThoughItIsReportedForTwoJobs) {
  submit("a", tiles(100, 8));
  submit("b", tiles(100, 8));
  restart();
  const LeaseDescription first{LeaseId{5}, {"a"}, {{0, {0, 1}}}}, second{LeaseId{5}, {"b"}, {{0, {0, 1}}}};
  EXPECT_EQ(sync("w", {first, second}, 0).leases, std::vector{first});
}

TEST_F(Restart, TakesOverNoMoreLeasesThanAWorkerMayHold) {
  submit("job", tiles(100, 8));
  restart();
  std::vector<LeaseDescription> held;
  for (int i = 1; i <= 6; ++i)
    held.push_back({LeaseId{static_cast<std::uint64_t>(i)}, {"job"}, {{i, {0, 8}}}});
  EXPECT_EQ(sync("w", held, 6).leases, std::vector(held.begin(), held.begin() + 4));
}

TEST_F(Restart, CountsResultsOfLeasesFromBefore) {
  submit("job", tiles(100, 8));
  const LeaseDescription lease = lease_to("w");
  restart();
  EXPECT_THAT(deliver("w", lease).verdicts, testing::Each(Verdict::kAccepted));
}

TEST_F(Restart, KeepsTheOrderOfJobs) {
  for (const char* id : {"zebra", "ant", "mole"}) submit(id, tiles(2, 1));
  restart();
  std::vector<std::string> order;
  for (const JobView& view : scheduler_->jobs(now_)) order.push_back(view.id.value);
  EXPECT_THAT(order, ElementsAre("zebra", "ant", "mole"));
  EXPECT_EQ(lease_to("w").job, JobId{"zebra"});
}

TEST_F(Restart, KeepsWhyAJobFailed) {
  submit("job", tiles(2, 1));
  const FailureDetails details{FailureReason::kFileLost, std::nullopt, {"a"}};
  handle(FailJob{{"job"}, "no such mesh", details});
  restart();
  EXPECT_EQ(job("job").failure, "no such mesh");
  EXPECT_EQ(job("job").failure_details, details);
  EXPECT_TRUE(sync("w").leases.empty());
}

TEST_F(Restart, FinishesAJobWhoseLastSampleWasStoredButNotItsState) {
  const std::vector<IntervalSet> all(2, IntervalSet{{0, 4}});
  EXPECT_THAT(handle(RestoreJob{{"job"}, tiles(2, 4), 0, kRunning, "", all}).job_changes,
              ElementsAre(JobChange{{"job"}, kRunning, kDone}));
}

TEST_F(Restart, RunsADoneJobThatLacksSamples) {
  const std::vector<IntervalSet> most{{{0, 4}}, {{0, 3}}};
  EXPECT_THAT(handle(RestoreJob{{"job"}, tiles(2, 4), 0, kDone, "", most}).job_changes,
              ElementsAre(JobChange{{"job"}, kDone, kRunning}));
  EXPECT_EQ(lease_to("w").items, (std::vector<WorkItem>{{1, {3, 4}}}));
}

TEST_F(Restart, RefusesSamplesThatAreNotOfTheJob) {
  for (const std::vector<IntervalSet>& wrong : {std::vector<IntervalSet>{}, std::vector<IntervalSet>(3),
                                                std::vector<IntervalSet>{{{0, 4}}, {{0, 5}}}}) {
    EXPECT_EQ(handle(RestoreJob{{"job"}, tiles(2, 4), 0, kRunning, "", wrong}).status.error().code,
              core::ErrorCode::kInvalidArgument);
  }
  EXPECT_TRUE(scheduler_->jobs(now_).empty());
}

}  // namespace
}  // namespace tessera::scheduler
