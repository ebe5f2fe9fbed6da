// SPDX-License-Identifier: Apache-2.0
// Results that are accepted, dropped or rejected.
#include <limits>

#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using enum Verdict;

// Signs leases with readable tokens.
class SignedLeases : public Farm {
 protected:
  SignedLeases() : Farm(signing()) {}

  Actions deliver_with(const std::string& worker, const LeaseDescription& lease, const LeaseToken& token) {
    SubmitResult result{{worker}, lease.job, lease.id, lease.items, 0.25, true};
    result.token = token;
    return handle(result);
  }

 private:
  static Options signing() {
    Options options;
    options.sign = [](LeaseId lease, const WorkerId& holder, const JobId& job) {
      return std::to_string(lease.value) + " " + holder.value + " " + job.value;
    };
    return options;
  }
};

TEST_F(SignedLeases, CountForTheirHolderAlone) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  const LeaseDescription other = lease_to("other");
  for (const std::string worker : {"w", "stranger", "other"}) {
    for (const LeaseToken& token : {LeaseToken(), other.token}) {
      EXPECT_EQ(deliver_with(worker, lease, token).status.error().code, core::ErrorCode::kInvalidArgument);
    }
  }
  EXPECT_FALSE(deliver_with("stranger", lease, lease.token).status);
  EXPECT_EQ(job("job").samples_done, 0u);
  EXPECT_THAT(deliver_with("w", lease, lease.token).verdicts, testing::Each(kAccepted));
}

TEST_F(SignedLeases, CountAfterARestart) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  restart();
  EXPECT_THAT(deliver_with("w", lease, lease.token).verdicts, testing::Each(kAccepted));
}

TEST_F(SignedLeases, AreTakenOverFromTheirHolderAlone) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  restart();
  const Reply claimed = sync("liar", {lease}, 0);
  EXPECT_THAT(claimed.leases, testing::IsEmpty());
  const Reply taken_over = sync("w", {lease}, 0);
  EXPECT_THAT(taken_over.leases, ElementsAre(lease));
}

using Results = FarmOfSmallLeases;
using ResultsOfParts = Farm;

TEST_F(Results, CountOnce) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  ASSERT_EQ(lease.items.size(), 1u);
  EXPECT_THAT(deliver("w", lease).verdicts, ElementsAre(kAccepted));
  EXPECT_THAT(deliver("w", lease).verdicts, ElementsAre(kDropped));
  EXPECT_EQ(job("job").samples_done, kTilePixels);
  EXPECT_EQ(scheduler_->done({"job"}, 0), (IntervalSet{{0, 1}}));
}

TEST_F(Results, CountOnceWithinOneDelivery) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  EXPECT_THAT(deliver("w", lease, {{0, {0, 2}}, {0, {1, 3}}, {0, {2, 4}}}).verdicts,
              ElementsAre(kAccepted, kDropped, kAccepted));
}

TEST_F(Results, AreDroppedIfAnyOfTheirSamplesIsThereAlready) {
  submit("job", tiles(2, 8));
  const LeaseDescription lease = lease_to("w");
  deliver("w", lease, {{0, {2, 4}}});
  EXPECT_THAT(deliver("w", lease, {{0, {0, 3}}}).verdicts, ElementsAre(kDropped));
  EXPECT_EQ(scheduler_->done({"job"}, 0), (IntervalSet{{2, 4}}));
}

TEST_F(Results, CountForLeasesFromBeforeARestart) {
  submit("job", tiles(2, 4));
  EXPECT_THAT(deliver("stranger", {LeaseId{77}, {"job"}, {{1, {0, 4}}}}).verdicts, ElementsAre(kAccepted));
}

TEST_F(Results, CountAfterTheLeaseRanOut) {
  submit("job", tiles(2, 4));
  const LeaseDescription late = lease_to("hung");
  pass(seconds(60));
  tick();
  EXPECT_THAT(deliver("hung", late).verdicts, ElementsAre(kAccepted));
}

TEST_F(Results, AreDroppedIfTheRangeIsComplete) {
  submit("job", tiles(2, 4));
  const LeaseDescription late = lease_to("hung");
  pass(seconds(60));
  deliver("quick", lease_to("quick"));
  EXPECT_THAT(deliver("hung", late).verdicts, ElementsAre(kDropped));
}

TEST_F(Results, ThatWereNotRequestedAreNotRenderedAgain) {
  submit("job", tiles(2, 4));
  deliver("stranger", {LeaseId{77}, {"job"}, {{0, {0, 4}}}});
  for (const WorkItem& item : render_all("w")) EXPECT_EQ(item.tile, 1);
  EXPECT_EQ(state("job"), JobState::kDone);
}

TEST_F(ResultsOfParts, OfAPartLeaveTheRestWithTheWorker) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("w");
  deliver("w", lease, {lease.items[0]}, false);
  const Reply reply = sync("w", {lease});
  ASSERT_EQ(reply.leases.size(), 1u);
  EXPECT_EQ(reply.leases[0].id, lease.id);
  EXPECT_EQ(reply.leases[0].items, std::vector<WorkItem>(lease.items.begin() + 1, lease.items.end()));
}

TEST_F(ResultsOfParts, ThatFinishALeaseEarlyFreeItsRestAtOnce) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("stopping");
  deliver("stopping", lease, {lease.items[0]}, true);
  EXPECT_EQ(lease_to("other").items,
            (std::vector<WorkItem>{lease.items[1], lease.items[2], lease.items[3], {4, {0, 1}}}));
}

TEST_F(Results, MayBeTheFirstPartOfARange) {
  submit("job", tiles(2, 64));
  const LeaseDescription lease{LeaseId{1}, {"job"}, {{0, {32, 64}}}};
  restart();
  sync("w", {lease});
  deliver("w", lease, {{0, {32, 40}}}, true);
  IntervalSet expected{{0, 32}, {40, 64}};
  IntervalSet rendered;
  for (const WorkItem& item : render_all("v")) {
    if (item.tile == 0) rendered.add(item.samples);
  }
  EXPECT_EQ(rendered, expected);
}

TEST_F(Results, CannotFinishTheLeaseOfAnother) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("holder");
  EXPECT_FALSE(deliver("liar", lease, {}, true).status);
  EXPECT_EQ(job("job").active_workers, 1);
  EXPECT_EQ(sync("holder", {lease}).leases, std::vector{lease});
}

TEST_F(Results, ForLeasesTheWorkerNeverHadAreRefused) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("holder");
  LeaseDescription invented = lease;
  for (const std::uint64_t id :
       {std::uint64_t{0}, lease.id.value + 1, lease.id.value + (std::uint64_t{1} << 40)}) {
    invented.id = {id};
    const Actions actions = deliver("holder", invented);
    ASSERT_FALSE(actions.status);
    EXPECT_THAT(actions.status.error().message, testing::HasSubstr("was never given"));
  }
  EXPECT_THAT(deliver("liar", lease).status.error().message,
              testing::HasSubstr("was not given to this worker"));
  EXPECT_EQ(job("job").samples_done, 0u);
  EXPECT_TRUE(deliver("holder", lease).status);
}

TEST_F(Results, OfADismissedWorkerComeFromOthers) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("a");
  handle(Dismiss{{"a"}});
  EXPECT_EQ(job("job").active_workers, 0);
  EXPECT_EQ(lease_to("b").items, lease.items);
  EXPECT_EQ(handle(Dismiss{{"nobody"}}).status.error().code, core::ErrorCode::kNotFound);
}

TEST_F(Results, ThatAreNoPartOfTheJobAreRefusedWhole) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  for (const WorkItem& wrong :
       {WorkItem{kNoTile, {0, 1}}, {2, {0, 1}}, {1, {0, 5}}, {1, {2, 2}}, {1, {3, 2}}}) {
    const Actions actions = deliver("w", lease, {{0, {0, 1}}, wrong});
    ASSERT_FALSE(actions.status);
    EXPECT_EQ(actions.status.error().code, core::ErrorCode::kInvalidArgument);
    EXPECT_THAT(actions.status.error().message, testing::HasSubstr("not part of job job"));
    EXPECT_TRUE(actions.verdicts.empty());
  }
  EXPECT_EQ(job("job").samples_done, 0u);
  EXPECT_EQ(sync("w", {lease}).leases, std::vector{lease});
}

TEST_F(Results, CountForAPausedJob) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  handle(PauseJob{{"job"}});
  EXPECT_THAT(deliver("w", lease).verdicts, ElementsAre(kAccepted));
}

TEST_F(Results, AreDroppedForJobsThatWereCancelledFailedOrDeleted) {
  for (const char* id : {"cancelled", "failed", "deleted"}) submit(id, tiles(2, 4));
  handle(CancelJob{{"cancelled"}});
  handle(FailJob{{"failed"}, "no such texture"});
  handle(DeleteJob{{"deleted"}});
  for (const char* id : {"cancelled", "failed", "deleted"}) {
    const Actions actions = deliver("w", {LeaseId{1}, {id}, {{0, {0, 1}}}});
    EXPECT_TRUE(actions.status);
    EXPECT_THAT(actions.verdicts, ElementsAre(kDropped)) << id;
  }
}

TEST_F(Results, FinishTheJobWithItsLastSample) {
  submit("job", tiles(2, 1));
  const LeaseDescription first = lease_to("w");
  EXPECT_TRUE(deliver("w", first).job_changes.empty());
  const LeaseDescription last = lease_to("w");
  EXPECT_THAT(deliver("w", last).job_changes,
              ElementsAre(JobChange{{"job"}, JobState::kRunning, JobState::kDone}));
  EXPECT_EQ(job("job").samples_done, job("job").samples_total);
}

TEST_F(ResultsOfParts, TeachNothingByAnAbsurdTime) {
  submit("job", tiles(4000, 4096));
  for (const double render_seconds :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const LeaseDescription lease = lease_to("w");
    EXPECT_EQ(lease.items.size(), 4u) << render_seconds;
    deliver("w", lease, lease.items, true, render_seconds);
  }
}

TEST_F(Results, AreCreditedToTheirWorker) {
  submit("job", tiles(2, 4));
  const LeaseDescription lease = lease_to("w");
  deliver("w", lease);
  deliver("w", lease);
  EXPECT_EQ(scheduler_->workers(now_)[0].samples_accepted, kTilePixels);
}

}  // namespace
}  // namespace tessera::scheduler
