// SPDX-License-Identifier: Apache-2.0
// Samples that may kill workers: when they are suspected, how they are leased, and when their job fails.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> names(const PoisonTracker::Part& part) {
  std::vector<std::string> names;
  for (const Loss& loss : part.losses) names.push_back(loss.name);
  return names;
}

TEST(PoisonTrackerTest, PartsAreCutWhereTheDeathsDiffer) {
  PoisonTracker poison;
  poison.strike({3, {4, 12}}, {{"1"}, "a"}, false);
  poison.strike({3, {8, 16}}, {{"2"}, "b"}, true);
  poison.strike({3, {8, 10}}, {{"2"}, "b"}, true);
  const PoisonTracker::Part before = poison.first_part({3, {0, 32}});
  EXPECT_EQ(before.samples, (core::SampleRange{0, 4}));
  EXPECT_TRUE(before.losses.empty());
  EXPECT_EQ(poison.first_part({3, {4, 32}}).samples, (core::SampleRange{4, 8}));
  EXPECT_THAT(names(poison.first_part({3, {9, 32}})), ElementsAre("a", "b"));
  EXPECT_EQ(poison.first_part({3, {12, 14}}).samples, (core::SampleRange{12, 14}));
  EXPECT_TRUE(poison.first_part({3, {16, 32}}).losses.empty());
  EXPECT_TRUE(poison.first_part({2, {4, 12}}).losses.empty());
}

TEST(PoisonTrackerTest, DeathsThatMayHaveHadOneCauseCountOnce) {
  PoisonTracker poison;
  poison.strike({3, {0, 4}}, {{"1"}, "a"}, false);
  poison.strike({3, {0, 4}}, {{"2"}, "b"}, false);
  EXPECT_THAT(names(poison.first_part({3, {0, 4}})), ElementsAre("a"));
}

TEST(PoisonTrackerTest, RenderedSamplesAndWorkersThatLiveAreForgotten) {
  PoisonTracker poison;
  poison.strike({0, {0, 8}}, {{"1"}, "a"}, false);
  poison.strike({0, {0, 8}}, {{"2"}, "b"}, true);
  poison.clear({0, {2, 4}});
  EXPECT_TRUE(poison.first_part({0, {2, 4}}).losses.empty());
  poison.withdraw_strikes({"1"}, LossKind::kDied);
  EXPECT_THAT(names(poison.first_part({0, {0, 2}})), ElementsAre("b"));
  poison.withdraw_strikes({"2"}, LossKind::kDied);
  EXPECT_EQ(poison.first_part({0, {0, 8}}).samples, (core::SampleRange{0, 8}));
}

TEST(PoisonTrackerTest, PartsThatKeepAWorkerEachAreOneRange) {
  PoisonTracker poison;
  poison.strike({0, {4, 12}}, {{"1"}, "a", LossKind::kStuck}, true);
  poison.strike({0, {4, 6}}, {{"2"}, "b", LossKind::kStuck}, true);
  poison.strike({0, {9, 10}}, {{"3"}, "c", LossKind::kStuck}, true);
  EXPECT_THAT(names(poison.first_part({0, {9, 10}})), ElementsAre("a", "b", "c"));
  EXPECT_EQ(poison.to_be_told({0, {9, 10}}), (core::SampleRange{4, 12}));
  poison.withdraw_strikes({"2"}, LossKind::kDied);
  poison.withdraw_strikes({"3"}, LossKind::kStuck);
  EXPECT_EQ(poison.to_be_told({0, {4, 6}}), (core::SampleRange{4, 6})) << "both were there";
  EXPECT_THAT(names(poison.first_part({0, {4, 12}})), ElementsAre("a", "b"));
}

class Deaths : public Farm {
 protected:
  // The worker takes leases, reports them, and then sends no more heartbeats.
  LeaseDescription die(const std::string& worker) { return die(worker, worker); }
  LeaseDescription die(const std::string& id, const std::string& name) {
    const LeaseDescription lease = handle(Synchronize{{{id}, name, "0.1.0", 1}, {}, 1}).reply->leases.at(0);
    handle(Synchronize{{{id}, name, "0.1.0", 1}, {lease}, 1});
    pass(seconds(10));
    tick();
    return lease;
  }
};

TEST_F(Deaths, OfThreeWorkersInARowFailTheJob) {
  submit("job", tiles(100, 16));
  submit("other", tiles(2, 1), -1);
  EXPECT_EQ(die("a").items.size(), 4u);
  EXPECT_EQ(die("b").items, (std::vector<WorkItem>{{0, {0, 1}}})) << "alone";
  EXPECT_EQ(state("job"), JobState::kRunning);
  EXPECT_EQ(die("c").items, (std::vector<WorkItem>{{0, {0, 1}}}));
  EXPECT_EQ(state("job"), JobState::kFailed);
  EXPECT_THAT(job("job").failure,
              HasSubstr("3 workers died one after the other while they rendered samples [0, 1) of tile 0 "
                        "(pixels [0, 64) x [0, 64)): a (a), b (b), c (c)."));
  EXPECT_EQ(render_all("d").size(), 2u) << "the other job goes on";
}

TEST_F(Deaths, WhileSeveralItemsWereHeldOnlyRaiseSuspicion) {
  submit("job", tiles(100, 16));
  die("a");
  sync("b", {}, 4);
  ASSERT_EQ(scheduler_->workers(now_)[1].held_leases, 1) << "a suspect is all that a worker holds";
}

TEST_F(Deaths, DoNotCountWhenTheSamplesAreRenderedInBetween) {
  submit("job", tiles(100, 16));
  die("a");
  die("b");
  const LeaseDescription survived = lease_to("c");
  deliver("c", survived);
  EXPECT_EQ(lease_to("c").items, (std::vector<WorkItem>{{1, {0, 1}}}));
  EXPECT_EQ(state("job"), JobState::kRunning);
}

TEST_F(Deaths, OfWorkersThatComeBackWereNone) {
  submit("job", tiles(100, 16));
  die("a");
  die("b");
  sync("a", {}, 0);
  die("c");
  EXPECT_EQ(state("job"), JobState::kRunning);
  die("d");
  EXPECT_EQ(state("job"), JobState::kFailed);
}

TEST_F(Deaths, OfOneMachineCountOnce) {
  submit("job", tiles(100, 16));
  for (int process = 0; process < 10; ++process) die("process " + std::to_string(process), "machine");
  EXPECT_EQ(state("job"), JobState::kRunning);
  die("b");
  die("c");
  EXPECT_EQ(state("job"), JobState::kFailed);
}

// One caller can invent any number of names.
TEST_F(Deaths, OfOneCallersWorkersFailNoJobThatOthersRender) {
  submit("job", tiles(100, 16));
  const auto sync_as = [&](const std::string& name, const std::string& principal,
                           std::vector<LeaseDescription> held, int wanted) {
    WorkerInfo info{{name}, name, "0.1.0", 1, "", principal};
    return handle(Synchronize{info, std::move(held), wanted}).reply->leases;
  };
  const auto die_as = [&](const std::string& name, const std::string& principal) {
    sync_as(name, principal, sync_as(name, principal, {}, 1), 1);
    for (int i = 0; i < 2; ++i) {
      pass(seconds(5));
      sync_as("honest", "b", {}, 0);
    }
    tick();
  };
  sync_as("honest", "b", {}, 0);
  for (int i = 0; i < 18; ++i) die_as("made up " + std::to_string(i), "a");
  EXPECT_EQ(state("job"), JobState::kRunning);
  pass(seconds(10));
  sync_as("honest", "b", sync_as("honest", "b", {}, 1), 1);
  pass(seconds(10));
  tick();
  EXPECT_EQ(state("job"), JobState::kFailed) << "all who are there have died of it";
}

TEST_F(Deaths, OfWorkersThatDeliverAfterAllWereNone) {
  submit("job", tiles(100, 16));
  const LeaseDescription late = die("a");
  die("b");
  deliver("a", late, {late.items[1]}, false);
  die("c");
  EXPECT_EQ(state("job"), JobState::kRunning);
}

TEST_F(Deaths, BeforeALeaseIsAcknowledgedAreNoStrikes) {
  submit("job", tiles(100, 16));
  lease_to("a");
  pass(seconds(10));
  tick();
  EXPECT_EQ(lease_to("b").items.size(), 4u);
}

const AreAll kNobodyElse = [](const std::set<std::string>&) { return true; };

TEST(JobTest, DoesNotFailWhileAnotherWorkerHoldsTheSamples) {
  Job job(1, {"job"}, tiles(4, 1), {}, JobState::kRunning, {});
  const std::vector<WorkItem> items = job.next_free({1, 1}, true).items;
  job.lease({{1}, {"slow"}, items, false});
  const auto strike = [&](std::uint64_t id, const std::string& worker) {
    job.lease({{id}, {worker}, items, true});
    return job.strike(job.end_lease({id}, LeaseState::kExpired), {{worker}, worker}, kNobodyElse);
  };
  EXPECT_FALSE(strike(2, "a"));
  EXPECT_FALSE(strike(3, "b"));
  EXPECT_FALSE(strike(4, "c"));
  job.end_lease({1}, LeaseState::kReturned);
  EXPECT_TRUE(strike(5, "c"));
}

TEST(JobTest, CountsStuckWorkersAgainstMissingSamples) {
  Job job(1, {"job"}, tiles(4, 8), {}, JobState::kRunning, {});
  std::vector<Lease> ended;
  ASSERT_TRUE(job.accept({0, {0, 2}}, ended));
  const auto strike = [&](const std::string& worker, const std::vector<WorkItem>& items) {
    return job.strike(items, {{worker}, worker, LossKind::kStuck}, kNobodyElse);
  };
  for (const char* worker : {"a", "b", "c"}) EXPECT_FALSE(strike(worker, {{0, {0, 2}}})) << "it ends";
  EXPECT_FALSE(strike("a", {{0, {1, 4}}}));
  EXPECT_FALSE(strike("b", {{0, {1, 4}}}));
  const auto failure = strike("c", {{1, {0, 1}}, {0, {1, 4}}});
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->message, HasSubstr("samples [2, 4) of tile 0"));
}

TEST(JobTest, FailsForAnyPartOfWhatAWorkerIsStuckIn) {
  Job job(1, {"job"}, tiles(4, 8), {}, JobState::kRunning, {});
  std::uint64_t id = 0;
  for (const char* worker : {"a", "b"}) {
    job.lease({{++id}, {worker}, {{0, {6, 7}}}, true});
    EXPECT_FALSE(job.strike(job.end_lease({id}, LeaseState::kExpired), {{worker}, worker}, kNobodyElse));
  }
  const auto failure = job.strike({{0, {4, 8}}}, {{"c"}, "c", LossKind::kStuck}, kNobodyElse);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->message, HasSubstr("samples [6, 7) of tile 0"));
  EXPECT_EQ(failure->details.reason, FailureReason::kWorkersLost);
  EXPECT_EQ(failure->details.item, (WorkItem{0, {6, 7}}));
  EXPECT_THAT(failure->details.workers, testing::ElementsAre("a", "b", "c"));
}

TEST_F(Deaths, AfterTwoTheSamplesAreLeasedOneByOne) {
  submit("job", tiles(2, 16));
  const LeaseDescription first = lease_to("quick");
  deliver("quick", first, first.items, true, 0.001);
  const LeaseDescription rest = lease_to("quick");
  ASSERT_FALSE(rest.items.empty());
  sync("quick", {rest});
  pass(seconds(10));
  tick();
  ASSERT_GT(die("b").items.at(0).samples.count(), 1u);
  EXPECT_EQ(lease_to("c").items.at(0).samples.count(), 1u);
}

TEST_F(Deaths, AreNotInferredFromASuspendedCoordinator) {
  submit("job", tiles(100, 16));
  const LeaseDescription lost = lease_to("a");
  sync("a", {lost});
  pass(seconds(12));
  tick();
  EXPECT_EQ(lease_to("b").items, lost.items);
}

TEST_F(Deaths, OfStoppedWorkersAreNoStrikes) {
  submit("job", tiles(100, 16));
  const LeaseDescription lease = lease_to("a");
  sync("a", {lease}, 1, true);
  pass(seconds(10));
  EXPECT_EQ(lease_to("b").items.size(), 4u);
}

TEST_F(Deaths, SuspectsWaitForAWorkerThatHoldsNothing) {
  submit("job", tiles(100, 16));
  const LeaseDescription held = lease_to("busy");
  const LeaseDescription lost = lease_to("a");
  sync("a", {lost});
  pass(seconds(5));
  sync("busy", {held});
  pass(seconds(5));
  EXPECT_EQ(sync("busy", {held}, 2).leases.size(), 1u);
  deliver("busy", held);
  EXPECT_EQ(lease_to("busy").items, (std::vector<WorkItem>{lost.items[0]}));
}

}  // namespace
}  // namespace tessera::scheduler
