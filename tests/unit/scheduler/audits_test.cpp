// SPDX-License-Identifier: Apache-2.0
// Which worker audits what, and how long a job waits for audits.
#include "tests/unit/scheduler/audited_farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using enum JobState;

struct Audits : AuditsOf {
  Audits() : AuditsOf(1) {}
};

TEST_F(Audits, AreForWorkersOfAnotherName) {
  submit("job", tiles(4, 1));
  const LeaseDescription rendered = lease_to("a");
  deliver_sums("a", rendered, honest);
  EXPECT_EQ(job("job").samples_done, job("job").samples_total);
  EXPECT_EQ(job("job").samples_to_verify, job("job").samples_total);
  EXPECT_EQ(state("job"), kRunning);
  EXPECT_THAT(sync("a").leases, IsEmpty());

  const LeaseDescription again = lease_to("b");
  EXPECT_EQ(again.items, rendered.items);
  const Actions actions = deliver_sums("b", again, honest);
  EXPECT_THAT(actions.verdicts, testing::Each(Verdict::kAudited));
  EXPECT_THAT(actions.job_changes, ElementsAre(JobChange{{"job"}, kRunning, kDone}));
  EXPECT_EQ(worker("a").audited_ranges, 4u);
  EXPECT_EQ(worker("a").disproved_ranges, 0u);
}

TEST_F(Audits, AreForNoOtherProcessOfTheSameMachine) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  const Reply reply = *handle(Synchronize{{{"a's other process"}, "a", "0.1.0", 1}, {}, 1}).reply;
  EXPECT_THAT(reply.leases, IsEmpty());
}

// The registry links earlier results of a worker to the name that it reports later.
TEST_F(Audits, AreNotAssignedToUnregisteredProducers) {
  submit("job", tiles(2, 1));
  restart();
  deliver_sums("w", {LeaseId{7}, {"job"}, {}}, {{0, {0, 1}}, {1, {0, 1}}}, honest);
  const auto named = [&](const std::string& id) {
    return handle(Synchronize{{{id}, "machine", "0.1.0", 1}, {}, 1}).reply->leases;
  };
  EXPECT_THAT(named("w"), IsEmpty());
  EXPECT_THAT(named("v"), IsEmpty());
  EXPECT_FALSE(sync("another").leases.empty());
}

TEST_F(Audits, OfAHigherPriorityComeFirstAndOfALowerOneWait) {
  submit("low", tiles(4, 1), 0);
  deliver_sums("a", lease_to("a"), honest);
  submit("high", tiles(4, 1), 1);
  EXPECT_EQ(lease_to("b").job.value, "high");
}

// Adjacent ranges of one lease would be delivered as one.
TEST_F(Audits, OfRangesThatTouchAreInSeveralLeases) {
  submit("job", tiles(2, 4));
  restart();
  deliver_sums("a", {LeaseId{7}, {"job"}, {}}, {{0, {0, 1}}, {0, {1, 2}}, {0, {2, 4}}, {1, {0, 4}}}, honest);
  const Reply reply = sync("b", {}, 2);
  ASSERT_EQ(reply.leases.size(), 2u);
  EXPECT_EQ(reply.leases[0].items, (std::vector<WorkItem>{{0, {0, 1}}, {0, {2, 4}}, {1, {0, 4}}}));
  EXPECT_EQ(reply.leases[1].items, (std::vector<WorkItem>{{0, {1, 2}}}));
}

TEST_F(Audits, AreLeasesOfTheWorkersThatAJobMayHave) {
  submit("job", tiles(2, 1), 0, 1);
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription lease = lease_to("b");
  EXPECT_EQ(job("job").active_workers, 1);
  EXPECT_THAT(sync("c").leases, IsEmpty());
  const Actions part = deliver_sums("b", lease, {lease.items[0]}, honest, false);
  EXPECT_THAT(part.wake, IsEmpty());
  // It gave the rest back, so another worker may take its place.
  const Actions rest = deliver_sums("b", lease, {}, honest);
  EXPECT_THAT(rest.wake, testing::Contains(WorkerId{"c"}));
  EXPECT_EQ(lease_to("c").items, std::vector{lease.items[1]});
}

// More workers than a lowered limit allows may hold audits of the job, which breaks no invariant.
TEST_F(Audits, OutliveALowerLimitOnWorkers) {
  submit("job", tiles(2, 1));
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription by_b = lease_to("b"), by_c = lease_to("c");
  ASSERT_TRUE(handle(UpdateJob{{"job"}, {}, 1}).status);
  EXPECT_EQ(job("job").active_workers, 2);
  deliver_sums("c", by_c, honest);
  EXPECT_EQ(job("job").active_workers, 1);
  EXPECT_THAT(sync("c").leases, IsEmpty());
  deliver_sums("b", by_b, std::vector{by_b.items[1]}, honest);
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Audits, ThatNobodyDoesAreReportedOnce) {
  const auto reported = [&] { return handle(Tick{}).unattended; };
  submit("job", tiles(2, 1));
  render("a");
  pass(std::chrono::seconds(4));
  EXPECT_THAT(reported(), IsEmpty());
  pass(std::chrono::seconds(1));
  const auto first = reported();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].job.value, "job");
  EXPECT_EQ(first[0].samples, 2 * kTilePixels);
  pass(std::chrono::seconds(1));
  EXPECT_THAT(reported(), IsEmpty());

  sync("b", {lease_to("b")}, 1);
  pass(std::chrono::seconds(6));
  EXPECT_THAT(reported(), IsEmpty());
  sync("b", {}, 0);  // gives it back
  pass(std::chrono::seconds(5));
  EXPECT_EQ(reported().size(), 1u);
}

TEST_F(Audits, OfManyJobsThatNobodyDoesAreReportedWithSeveralEvents) {
  options_.per_event.reported_jobs = 2;
  start_again({});
  for (const char* const id : {"x", "y", "z"}) submit(id, tiles(2, 1));
  render("a");
  pass(std::chrono::seconds(5));
  EXPECT_EQ(handle(Tick{}).unattended.size(), 2u);
  EXPECT_EQ(handle(Tick{}).unattended.size(), 1u);
  EXPECT_THAT(handle(Tick{}).unattended, IsEmpty());
}

// Audits count as work that a job is given when jobs share the farm, like missing samples.
TEST_F(Audits, AreWorkThatAJobIsGiven) {
  submit("x", tiles(200, 1));
  submit("y", tiles(200, 1));
  render("a");
  options_.audit_share = 0;
  restart();
  const auto job_given_to = [&](const std::string& id, int threads) {
    const Reply reply = *handle(Synchronize{{{id}, id, "0.1.0", threads}, {}, 1}).reply;
    return reply.leases.at(0).job.value;
  };
  EXPECT_EQ(job_given_to("b", 4), "x");
  EXPECT_EQ(job_given_to("c", 1), "y");
  EXPECT_EQ(job_given_to("d", 1), "y");
}

TEST_F(Audits, MayComeInParts) {
  submit("job", tiles(2, 8));
  restart();
  const LeaseDescription before{LeaseId{7}, {"job"}, {}};
  deliver_sums("a", before, {{0, {0, 8}}, {1, {0, 8}}}, honest);
  const LeaseDescription lease = lease_to("b");
  ASSERT_EQ(lease.items, (std::vector<WorkItem>{{0, {0, 8}}, {1, {0, 8}}}));
  deliver_sums("b", lease, {{0, {0, 3}}}, honest, false);
  EXPECT_EQ(sync("b", {lease}).leases[0].items, (std::vector<WorkItem>{{0, {3, 8}}, {1, {0, 8}}}));
  EXPECT_EQ(job("job").samples_to_verify, 16 * kTilePixels);
  deliver_sums("b", lease, {{0, {3, 8}}}, honest, false);
  EXPECT_EQ(job("job").samples_to_verify, 8 * kTilePixels);
  deliver_sums("b", lease, {{1, {0, 8}}}, honest);
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Audits, RestartAfterACrash) {
  submit("job", tiles(2, 8));
  restart();
  deliver_sums("a", {LeaseId{7}, {"job"}, {}}, {{0, {0, 8}}, {1, {0, 8}}}, honest);
  const LeaseDescription lease = lease_to("stopping");
  deliver_sums("stopping", lease, {{0, {0, 3}}}, honest);
  EXPECT_EQ(lease_to("b").items, (std::vector<WorkItem>{{0, {0, 8}}, {1, {0, 8}}}));
}

TEST_F(Audits, CountOnce) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription lease = lease_to("b");
  deliver_sums("b", lease, {lease.items[0]}, honest, false);
  EXPECT_THAT(deliver_sums("b", lease, {lease.items[0]}, honest, false).verdicts,
              ElementsAre(Verdict::kDropped));
}

TEST_F(Audits, OfALostWorkerAreReassigned) {
  submit("job", tiles(4, 1));
  const LeaseDescription rendered = lease_to("a");
  deliver_sums("a", rendered, honest);
  const LeaseDescription lost = lease_to("b");
  pass(seconds(11));
  tick();
  EXPECT_EQ(lease_to("c").items, lost.items);
}

TEST_F(Audits, ThatTakeLongAreGivenToAnotherAsWell) {
  submit("job", tiles(2, 1));
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription slow = lease_to("slow");
  const LeaseDescription copy = lease_to("quick");
  EXPECT_EQ(copy.items[0], slow.items[0]);
  EXPECT_EQ(lease_to("third").items, std::vector{slow.items[1]});
  EXPECT_THAT(sync("fourth").leases, IsEmpty());
  render("quick");
  render("third");
  EXPECT_EQ(state("job"), kDone);
  EXPECT_THAT(sync("slow", {slow}).leases, IsEmpty());
}

TEST_F(Audits, TimeOutWithoutAuditors) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(state("job"), kRunning);
    pass(seconds(9));
    EXPECT_THAT(sync("a").leases, IsEmpty());
  }
  EXPECT_LE(*scheduler_->next_deadline(), now_ + seconds(6));
  pass(seconds(6));
  const Actions actions = handle(Tick{});
  EXPECT_THAT(actions.job_changes, ElementsAre(JobChange{{"job"}, kRunning, kDone}));
  ASSERT_EQ(actions.unaudited.size(), 1u);
  EXPECT_EQ(actions.unaudited[0].ranges, 4u);
  EXPECT_EQ(job("job").samples_to_verify, 0u);
}

TEST_F(Audits, AreNotWaitedForIfTheOnlyOtherCannotBuildTheScene) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  for (int i = 0; i < 8 && state("job") == kRunning; ++i) {
    const LeaseDescription lease = lease_to("b");
    handle(SubmitResult{{"b"}, lease.job, lease.id, {}, 0, true, "out of memory"});
    sync("a");
    pass(seconds(9));
    tick();
  }
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Audits, AreKeptWhileAnAuditorIsRegistered) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  sync("b", {}, 0);
  for (int i = 0; i < 20; ++i) {
    pass(seconds(9));
    sync("b", {}, 0);
  }
  EXPECT_EQ(state("job"), kRunning);
}

// The patience starts again after an auditor was present, even if it has left.
TEST_F(Audits, RestartTheirTimeoutWhenAnAuditorRegisters) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  const auto wait = [&](int times) {
    for (int i = 0; i < times; ++i) {
      pass(seconds(9));
      EXPECT_THAT(sync("a").leases, IsEmpty());
    }
  };
  wait(6);
  sync("b", {}, 0);
  wait(8);  // a worker that is silent for ten seconds cannot audit
  EXPECT_EQ(state("job"), kRunning);
  wait(1);
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Audits, AreStillDueAfterARestart) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  options_.audit_share = 0;
  restart();
  EXPECT_EQ(job("job").samples_to_verify, job("job").samples_total);
  EXPECT_THAT(sync("a").leases, IsEmpty());
  render("b");
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Audits, OfSamplesThatKillTheirWorkersEndTheJob) {
  submit("job", tiles(2, 1));
  restart();
  deliver_sums("liar", {LeaseId{7}, {"job"}, {}}, {{0, {0, 1}}, {1, {0, 1}}}, wrong);
  for (int deaths = 0; deaths < 10 && state("job") == kRunning; ++deaths) {
    const std::string victim = "victim " + std::to_string(deaths);
    const LeaseDescription lease = lease_to(victim);
    sync(victim, {lease});
    pass(seconds(10));
    tick();
  }
  EXPECT_EQ(state("job"), kFailed);
  EXPECT_THAT(job("job").failure, HasSubstr("3 workers died one after the other"));
}

}  // namespace
}  // namespace tessera::scheduler
