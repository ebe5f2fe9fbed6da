// SPDX-License-Identifier: Apache-2.0
// Workers that send heartbeats, hold leases and deliver nothing: no lease is held for ever.
#include "tests/unit/scheduler/stalled_farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Stalls : public StalledFarm {};

TEST_F(Stalls, ALeaseOfWhichNothingComesEndsAfterTenLeaseDurations) {
  submit("job", tiles(100, 16), 0, 1);
  std::vector<LeaseDescription> held{lease_to("stuck")};
  const LeaseDescription lease = held.front();
  keep_reporting("stuck", held, seconds(95));
  EXPECT_THAT(held, ElementsAre(lease));
  EXPECT_THAT(sync("other").leases, IsEmpty()) << "the job may have one worker";
  const Actions last = keep_reporting("stuck", held, seconds(5));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_THAT(last.stalled,
              ElementsAre(HasSubstr("worker stuck (stuck) sends heartbeats, but has delivered nothing of "
                                    "job job for 100 s, where samples [0, 1) of tile 0 came first")));
  EXPECT_THAT(last.wake, ElementsAre(WorkerId{"other"}));
  EXPECT_EQ(handle(TopUp{{"other"}}).reply->leases.at(0).items, lease.items);
}

TEST_F(Stalls, ALeaseThatIsNeverReportedEndsAsWell) {
  submit("job", tiles(100, 16), 0, 1);
  lease_to("deaf");
  for (int i = 0; i < 19; ++i) {
    pass(seconds(5));
    EXPECT_EQ(sync("deaf").leases.size(), 1u);
  }
  pass(seconds(5));
  EXPECT_THAT(sync("deaf").leases, IsEmpty());
  EXPECT_EQ(job("job").active_workers, 0);
}

TEST_F(Stalls, ReturningLeasesIsNoProgress) {
  submit("job", tiles(100, 16));
  for (int i = 0; i < 10; ++i) {
    const LeaseDescription lease = lease_to("restless");
    pass(seconds(5));
    sync("restless", {lease});
    pass(seconds(5));
  }
  const LeaseDescription last = lease_to("restless");
  pass(seconds(5));
  EXPECT_THAT(sync("restless", {last}).leases, IsEmpty());
  EXPECT_EQ(sync("other").leases.size(), 1u);
}

TEST_F(Stalls, DuplicateResultsAreNoProgress) {
  submit("job", tiles(100, 16));
  const LeaseDescription first = lease_to("parrot");
  deliver("parrot", first);
  std::vector<LeaseDescription> held{lease_to("parrot")};
  for (int i = 0; i < 20 && !held.empty(); ++i) {
    keep_reporting("parrot", held, seconds(5));
    deliver("parrot", first, first.items, false);
  }
  EXPECT_THAT(held, IsEmpty());
}

TEST_F(Stalls, EveryFurtherOneBarsTheWorkerForTwiceAsLong) {
  submit("job", tiles(100, 16));
  show("stuck");
  for (const int bar : {100, 200, 400}) {
    std::vector<LeaseDescription> held{lease_to("stuck")};
    keep_reporting("stuck", held, seconds(100));
    keep_reporting("stuck", held, seconds(bar - 5));
    EXPECT_THAT(held, IsEmpty()) << bar;
    pass(seconds(5));
  }
}

TEST_F(Stalls, TheCooldownOfWorkersWithoutResultsDoesNotGrow) {
  submit("job", tiles(100, 16));
  for (int i = 0; i < 3; ++i) {
    std::vector<LeaseDescription> held{lease_to("new")};
    keep_reporting("new", held, seconds(100));
    ASSERT_THAT(view("new").cooldowns, testing::SizeIs(1));
    EXPECT_EQ(view("new").cooldowns[0].remaining, seconds(100));
    keep_reporting("new", held, seconds(95));
    EXPECT_THAT(held, IsEmpty());
    pass(seconds(5));
  }
}

TEST_F(Stalls, ALongFetchLosesTheLeaseWithoutCooldown) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("far")};
  const LeaseDescription lease = held.front();
  fetching_ = {{"job"}};
  const Actions last = keep_reporting("far", held, seconds(100));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_THAT(last.stalled, ElementsAre(HasSubstr("until it has the files of its scene")));
  EXPECT_EQ(lease_to("near").items, lease.items) << "others need not wait";
  keep_reporting("far", held, seconds(500));
  EXPECT_THAT(held, IsEmpty()) << "it can render nothing yet";
  EXPECT_TRUE(view("far").cooldowns.at(0).fetching);
  fetching_ = {};
  keep_reporting("far", held, seconds(5));
  EXPECT_EQ(held.size(), 1u);
  EXPECT_THAT(view("far").cooldowns, IsEmpty());
}

TEST_F(Stalls, RepeatedFetchesLeadToACooldown) {
  submit("job", tiles(100, 16));
  fetching_ = {{"job"}};
  for (int i = 0; i < 2; ++i) {
    std::vector<LeaseDescription> held{lease_to("liar")};
    keep_reporting("liar", held, seconds(100));
    EXPECT_THAT(held, IsEmpty());
  }
  EXPECT_THAT(sync("liar").leases, IsEmpty());
  EXPECT_EQ(view("liar").cooldowns.at(0).remaining, seconds(100));
}

TEST_F(Stalls, FetchingASceneExemptsOnlyItsJob) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("w")};
  fetching_ = {{"other"}};
  keep_reporting("w", held, seconds(100));
  fetching_ = {};
  keep_reporting("w", held, seconds(50));
  EXPECT_THAT(held, IsEmpty());
}

TEST_F(Stalls, KeepTheWorkerFromOtherJobsNot) {
  submit("job", tiles(100, 16), 1);
  std::vector<LeaseDescription> held{lease_to("stuck")};
  submit("other", tiles(100, 16));
  keep_reporting("stuck", held, seconds(100));
  ASSERT_EQ(held.size(), 1u);
  EXPECT_EQ(held[0].job, JobId{"other"});
}

TEST_F(Stalls, WhatComesAfterAllCountsAndEndsTheBar) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("slow")};
  const LeaseDescription lease = held.front();
  keep_reporting("slow", held, seconds(150));
  ASSERT_THAT(held, IsEmpty());
  const Actions late = deliver("slow", lease, {lease.items[0]}, false, 150);
  EXPECT_THAT(late.verdicts, ElementsAre(Verdict::kAccepted));
  EXPECT_EQ(sync("slow").leases.size(), 1u);
}

// 4096 pixel samples in 200 s: the next lease is a single sample of a tile, for which it has 2000 s.
TEST_F(Stalls, SlowWorkersHaveALongerTimeout) {
  submit("job", tiles(100, 16));
  const LeaseDescription first = lease_to("slow");
  deliver("slow", first, {first.items[0]}, true, 200);
  std::vector<LeaseDescription> held{lease_to("slow")};
  const LeaseDescription lease = held.front();
  EXPECT_EQ(lease.items.size(), 1u);
  keep_reporting("slow", held, seconds(1995));
  EXPECT_THAT(held, ElementsAre(lease));
  keep_reporting("slow", held, seconds(5));
  EXPECT_THAT(held, IsEmpty());
}

TEST_F(Stalls, EachDeliveryGivesTimeForTheNext) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("slow")};
  const LeaseDescription lease = held.front();
  ASSERT_EQ(lease.items.size(), 4u);
  for (int i = 0; i < 3; ++i) {
    keep_reporting("slow", held, seconds(90));
    deliver("slow", lease, {lease.items[static_cast<std::size_t>(i)]}, false, 1e-3);
  }
  keep_reporting("slow", held, seconds(90));
  ASSERT_EQ(held.size(), 1u);
  EXPECT_THAT(held[0].items, ElementsAre(lease.items[3]));
}

TEST_F(Stalls, AResultThatCannotBeTakenIsNoLackOfProgress) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("w")};
  const LeaseDescription lease = held.front();
  for (int i = 0; i < 10; ++i) {
    keep_reporting("w", held, seconds(90));
    handle(DeferResult{{"w"}, lease.id});
    handle(DeferResult{{"other"}, lease.id});
  }
  ASSERT_THAT(held, ElementsAre(lease));
  EXPECT_THAT(deliver("w", lease).verdicts, testing::Each(Verdict::kAccepted));
}

TEST_F(Stalls, OnlyTheHolderOfALeaseHasResultsOfIt) {
  submit("job", tiles(100, 16));
  const LeaseDescription of_other = lease_to("other");
  std::vector<LeaseDescription> held{lease_to("w")};
  keep_reporting("w", held, seconds(90));
  handle(DeferResult{{"w"}, of_other.id});
  keep_reporting("w", held, seconds(10));
  EXPECT_THAT(held, IsEmpty());
}

TEST_F(Stalls, AGapBetweenLeasesIsNoStrike) {
  submit("job", tiles(2, 1));
  const LeaseDescription lease = lease_to("w");
  pass(seconds(5));
  sync("w", {lease}, 0);
  deliver("w", lease, {lease.items[0]}, true);
  for (int i = 0; i < 100; ++i) {
    pass(seconds(5));
    sync("w", {}, 0);
  }
  std::vector<LeaseDescription> held{lease_to("w")};
  keep_reporting("w", held, seconds(95));
  EXPECT_EQ(held.size(), 1u);
}

// Progress by others, or a suspended coordinator, must not count against the worker.
TEST_F(Stalls, ARenewedLeaseRestartsItsTimer) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("w")};
  keep_reporting("w", held, seconds(95));
  pass(seconds(60));
  keep_reporting("w", held, seconds(95));
  EXPECT_EQ(held.size(), 1u);
}

}  // namespace
}  // namespace tessera::scheduler
