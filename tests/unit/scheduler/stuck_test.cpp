// SPDX-License-Identifier: Apache-2.0
// Workers that report the same samples for ever: they are given nothing, and the samples fail their job.
#include <fmt/format.h>

#include <optional>
#include <utility>

#include "tests/unit/scheduler/stalled_farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class StuckWorkers : public StalledFarm {};

TEST_F(StuckWorkers, GetNoLeasesWhileTheyRenderRevokedOnes) {
  submit("job", tiles(100, 16), 1);
  std::vector<LeaseDescription> held{lease_to("stuck")};
  submit("other", tiles(100, 16));
  keep_rendering("stuck", held, seconds(1000));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_TRUE(view("stuck").stuck);
  keep_reporting("stuck", held, seconds(5));
  EXPECT_EQ(held.size(), 1u);
  EXPECT_FALSE(view("stuck").stuck);
}

TEST_F(StuckWorkers, WhatWaitsBehindTheRangeThatKeepsItGoesToOthersAtOnce) {
  submit("job", tiles(100, 16), 1);
  std::vector<LeaseDescription> held{lease_to("stuck")};
  keep_rendering("stuck", held, seconds(60));
  submit("other", tiles(100, 16), 2);
  held = sync("stuck", held, 2).leases;
  ASSERT_EQ(held.size(), 2u);
  keep_rendering("stuck", held, seconds(40));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_EQ(job("other").active_workers, 0);
}

TEST_F(StuckWorkers, ASampleThatThreeWorkersComeToNoEndWithFailsItsJob) {
  submit("job", tiles(4, 8));
  submit("other", tiles(4, 8), -1);
  for (const char* name : {"a", "b", "c"}) show(name);
  const WorkItem a = lose("a"), b = lose("b");
  EXPECT_EQ(state("job"), JobState::kRunning);
  const WorkItem c = lose("c");
  EXPECT_EQ(b.tile, a.tile);
  EXPECT_EQ(b.samples.begin, a.samples.begin);
  EXPECT_EQ(c, (WorkItem{a.tile, {a.samples.begin, a.samples.begin + 1}}));
  EXPECT_EQ(state("job"), JobState::kFailed);
  EXPECT_THAT(last_.job_changes, ElementsAre(JobChange{{"job"}, JobState::kRunning, JobState::kFailed}));
  EXPECT_THAT(job("job").failure,
              HasSubstr(fmt::format("3 workers hung one after the other in samples [{}, {}) of "
                                    "tile {} (pixels [",
                                    c.samples.begin, c.samples.end, c.tile)));
  EXPECT_THAT(job("job").failure, HasSubstr("a (a), b (b), c (c)"));
  EXPECT_EQ(state("other"), JobState::kRunning);
}

TEST_F(StuckWorkers, WorkersThatHaveNotShownThatTheyCanDeliverFailNoJob) {
  submit("job", tiles(4, 8));
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    std::vector<LeaseDescription> held{lease_to(name)};
    keep_rendering(name, held, seconds(100));
    EXPECT_TRUE(view(name).stuck);
  }
  EXPECT_EQ(state("job"), JobState::kRunning);
}

// A broken machine hangs in every lease, and again after a restart.
TEST_F(StuckWorkers, AMachineThatIsBrokenCountsOnceUntilItDelivers) {
  submit("first", tiles(4, 8), 1);
  show("a");
  for (int i = 0; i < 5; ++i) {
    const std::string id = "a" + std::to_string(i);
    Actions last = handle(Synchronize{{{id}, "a", "0.1.0", 1}, {}, 1, false});
    for (int s = 0; s < 20; ++s) {
      pass(seconds(5));
      const std::vector<LeaseDescription> held = last.reply->leases;
      last = handle(Synchronize{{{id}, "a", "0.1.0", 1}, held, 1, false, {}, item_of(held.at(0), 0)});
    }
    EXPECT_THAT(last.reply->leases, IsEmpty());
  }
  EXPECT_EQ(state("first"), JobState::kRunning);
}

TEST_F(StuckWorkers, SlowWorkersAreReadmitted) {
  submit("job", tiles(4, 8));
  for (const char* name : {"a", "b", "c"}) show(name);
  lose("a");
  std::vector<LeaseDescription> none;
  keep_reporting("a", none, seconds(5));  // it renders something else now
  sync("a", {}, 1, true);
  lose("b");
  lose("c");
  EXPECT_EQ(state("job"), JobState::kRunning) << "two of three are left";
}

// No valid range takes an hour on any machine.
TEST_F(StuckWorkers, AnHourAtOneRangeCountsAgainstItInAnyCase) {
  submit("job", tiles(2, 1));
  for (const char* name : {"a", "b", "c"}) {
    EXPECT_EQ(lose(name, seconds(3595)), (WorkItem{0, {0, 1}}));
    EXPECT_EQ(state("job"), JobState::kRunning);
    std::vector<LeaseDescription> none;
    keep_saying(*stuck_in_, name, none, seconds(5));
  }
  EXPECT_EQ(state("job"), JobState::kFailed);
}

// They hold leases and say that they render, but deliver nothing.
TEST_F(StuckWorkers, OfOneCallerFailNoJobThatOthersMayRender) {
  submit("job", tiles(2, 1));
  const auto call = [&](const std::string& name, const std::string& origin,
                        std::vector<LeaseDescription> held, int wanted, std::optional<Rendering> rendering) {
    const WorkerInfo info{{name}, name, "0.1.0", 1, "", origin};
    return handle(Synchronize{info, std::move(held), wanted, false, {}, std::move(rendering)}).reply->leases;
  };
  const auto hang = [&](const std::string& name, const std::string& origin) {
    std::vector<LeaseDescription> held = call(name, origin, {}, 1, std::nullopt);
    const Rendering at = item_of(held.at(0), 0);
    for (const Time end = now_ + seconds(3605); now_ < end;) {
      pass(seconds(5));
      if (origin != "b") call("honest", "b", {}, 0, std::nullopt);
      held = call(name, origin, held, 1, at);
    }
  };
  for (const char* const name : {"a0", "a1", "a2", "a3"}) hang(name, "a");
  EXPECT_EQ(state("job"), JobState::kRunning);
  hang("honest", "b");
  EXPECT_EQ(state("job"), JobState::kFailed) << "all who are there hang in it";
}

TEST_F(StuckWorkers, AStuckWorkerDoesNotKeepAnUnbuildableJobRunning) {
  submit("job", tiles(100, 8));
  std::vector<LeaseDescription> held{lease_to("stuck")};
  const auto refuse = [&] {
    const Reply reply = sync("other");
    SubmitResult given_back{{"other"}, {"job"}, reply.leases.at(0).id, {}, 0, true};
    given_back.decline_reason = "out of memory";
    handle(given_back);
  };
  for (int i = 0; i < 3; ++i) refuse();
  keep_reporting("stuck", held, seconds(100));
  EXPECT_EQ(state("job"), JobState::kRunning);
  refuse();
  EXPECT_EQ(state("job"), JobState::kFailed);
}

TEST_F(StuckWorkers, CountAgainstTheItemThatTheyAreAtNotTheFirst) {
  submit("job", tiles(8, 16));
  for (const char* name : {"a", "b", "c"}) show(name);
  std::vector<LeaseDescription> held{lease_to("a")};
  const LeaseDescription lease = held.front();
  ASSERT_GT(lease.items.size(), 2u);
  keep_rendering("a", held, seconds(100), 2);
  const LeaseDescription before = lease_to("b");
  EXPECT_THAT(before.items, ElementsAre(lease.items[0], lease.items[1])) << "nobody suspects these";
  deliver("b", before);
  EXPECT_EQ(lose("b"), lease.items[2]);
  const core::SampleRange first{lease.items[2].samples.begin, lease.items[2].samples.begin + 1};
  EXPECT_EQ(lose("c"), (WorkItem{lease.items[2].tile, first}));
  EXPECT_EQ(state("job"), JobState::kFailed);
}

TEST_F(StuckWorkers, CountAgainstThePartOfAnItemThatTheyAreAt) {
  submit("job", tiles(2, 16));
  const LeaseDescription first = lease_to("quick");
  deliver("quick", first, first.items, true, 0.001);
  std::vector<LeaseDescription> held{lease_to("quick")};
  const Rendering item = item_of(held.front(), 0);
  ASSERT_GT(item.item.samples.count(), 1u);
  const std::uint32_t second = item.item.samples.begin + 1;
  const WorkItem part{item.item.tile, {second, second + 1}};
  keep_saying({item.lease, item.job, part}, "quick", held, seconds(100));
  const LeaseDescription before = lease_to("other");
  EXPECT_THAT(before.items, ElementsAre(WorkItem{part.tile, {second - 1, second}}));
  deliver("other", before);
  EXPECT_THAT(lease_to("other").items, ElementsAre(part));
}

TEST_F(StuckWorkers, ChangingItemsIsProgress) {
  submit("job", tiles(100, 16));
  show("slow");
  std::vector<LeaseDescription> held{lease_to("slow")};
  keep_rendering("slow", held, seconds(60), 0);
  keep_rendering("slow", held, seconds(40), 1);
  EXPECT_THAT(held, IsEmpty());
  keep_saying(*stuck_in_, "slow", held, seconds(55));
  EXPECT_GT(lease_to("other").items.size(), 1u) << "at neither for ten lease times";
}

TEST_F(StuckWorkers, ReachingTheNextItemClearsTheStuckState) {
  submit("job", tiles(100, 16));
  show("slow");
  std::vector<LeaseDescription> held{lease_to("slow")};
  const Rendering next = item_of(held.front(), 1);
  keep_rendering("slow", held, seconds(100), 0);
  EXPECT_TRUE(view("slow").stuck);
  keep_saying(next, "slow", held, seconds(5));
  EXPECT_FALSE(view("slow").stuck);
  EXPECT_GT(lease_to("other").items.size(), 1u);
}

TEST_F(StuckWorkers, WhatDoesNotFitTheLeaseCountsAgainstNothing) {
  submit("job", tiles(100, 16));
  const auto lies_about = [](const LeaseDescription& lease) {
    const WorkItem first = lease.items[0];
    return std::vector<Rendering>{{lease.id, lease.job, {99, {15, 16}}},
                                  {lease.id, lease.job, {first.tile, {15, 16}}},
                                  {lease.id, lease.job, {first.tile, {first.samples.end, 0}}},
                                  {lease.id, lease.job, {kNoTile, first.samples}},
                                  {lease.id, {}, {}},
                                  {{lease.id.value + 1}, lease.job, first}};
  };
  for (std::size_t lie = 0; lie < 6; ++lie) {
    const std::string name = fmt::format("liar {}", lie);
    show(name);
    std::vector<LeaseDescription> held{lease_to(name)};
    keep_saying(lies_about(held.front())[lie], name, held, seconds(100));
    EXPECT_THAT(held, IsEmpty()) << name;
    EXPECT_TRUE(view(name).stuck) << name;
    const LeaseDescription next = lease_to("honest");
    EXPECT_GT(next.items.size(), 1u) << name;
    deliver("honest", next);
  }
}

TEST_F(StuckWorkers, CountAgainstNoJobButThatOfTheLease) {
  submit("first", tiles(2, 1), 1);
  submit("job", tiles(100, 16));
  submit("other", tiles(100, 16), -1);
  show("liar");
  std::vector<LeaseDescription> held{lease_to("liar")};
  keep_saying({held[0].id, {"other"}, held[0].items[0]}, "liar", held, seconds(100));
  EXPECT_THAT(held, IsEmpty());
  handle(CancelJob{{"job"}});
  EXPECT_GT(lease_to("honest").items.size(), 1u);
}

// A restart forgets which workers have delivered, but not the leases.
TEST_F(StuckWorkers, CountAfterARestartWithinTheHour) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("a")};
  const LeaseDescription lease = held.front();
  keep_rendering("a", held, seconds(50), 1);
  restart();
  keep_saying(*stuck_in_, "a", held, seconds(3605));
  const LeaseDescription before = lease_to("b");
  EXPECT_THAT(before.items, ElementsAre(lease.items[0]));
  deliver("b", before);
  EXPECT_THAT(lease_to("b").items, ElementsAre(lease.items[1]));
}

TEST_F(StuckWorkers, WhatTheCoordinatorDoesNotKnowOfCountsAgainstNothing) {
  submit("job", tiles(100, 16));
  const LeaseDescription lost = lease_to("a");
  restart();
  std::vector<LeaseDescription> held;
  keep_saying(item_of(lost, 1), "a", held, seconds(5));
  EXPECT_EQ(held.size(), 1u);
  keep_saying(item_of(lost, 1), "a", held, seconds(3700));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_TRUE(view("a").stuck);
  EXPECT_GT(lease_to("b").items.size(), 1u);
}

TEST_F(StuckWorkers, HoldNothingInADeletedJob) {
  submit("job", tiles(100, 16), 1);
  submit("other", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("a")};
  const LeaseId lease = held.front().id;
  keep_rendering("a", held, seconds(100));
  handle(CancelJob{{"job"}});
  handle(DeleteJob{{"job"}});
  keep_saying({lease, {}, {}}, "a", held, seconds(50));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_TRUE(view("a").stuck);
}

}  // namespace
}  // namespace tessera::scheduler
