// SPDX-License-Identifier: Apache-2.0
// Limits on the workers that render a job at once.
#include <map>

#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

class Limits : public Farm {
 protected:
  Actions allow(const std::string& job, std::uint32_t max_workers) {
    return handle(UpdateJob{{job}, {}, max_workers});
  }
  int workers_of(const std::string& id) { return job(id).active_workers; }
};

class LimitsInSmallLeases : public FarmOfSmallLeases {};

TEST_F(Limits, HoldForNewLeases) {
  submit("job", tiles(100, 16), 0, 2);
  EXPECT_EQ(job("job").max_workers, 2u);
  const LeaseDescription a = lease_to("a");
  lease_to("b");
  EXPECT_THAT(sync("c").leases, IsEmpty());
  EXPECT_EQ(sync("a", {a}, 3).leases.size(), 3u) << "who renders it already may have more of it";
  EXPECT_EQ(workers_of("job"), 2);
}

TEST_F(LimitsInSmallLeases, HoldForCopiesAsWell) {
  submit("job", tiles(2, 1), 0, 2);
  lease_to("a"), lease_to("b");
  EXPECT_THAT(sync("c").leases, IsEmpty());
  ASSERT_TRUE(handle(UpdateJob{{"job"}, {}, 3}).status);
  EXPECT_EQ(lease_to("c").job, JobId{"job"});
  EXPECT_THAT(sync("d").leases, IsEmpty());
}

TEST_F(Limits, LeaveOtherWorkersToOtherJobs) {
  submit("urgent", tiles(1000, 16), 5, 1);
  submit("first", tiles(1000, 16));
  submit("second", tiles(1000, 16));
  std::map<std::string, int> leases;
  for (int w = 0; w < 11; ++w) ++leases[lease_to("w" + std::to_string(w)).job.value];
  EXPECT_EQ(leases["urgent"], 1);
  EXPECT_EQ(leases["first"], 5);
  EXPECT_EQ(leases["second"], 5);
}

TEST_F(Limits, GiveWhatAJobMayNotHaveToItsEquals) {
  submit("small", tiles(1000, 16), 0, 2);
  submit("middle", tiles(1000, 16), 0, 3);
  submit("large", tiles(1000, 16));
  std::map<std::string, int> leases;
  for (int w = 0; w < 12; ++w) ++leases[lease_to("w" + std::to_string(w)).job.value];
  EXPECT_EQ(leases["small"], 2);
  EXPECT_EQ(leases["middle"], 3);
  EXPECT_EQ(leases["large"], 7);
}

TEST_F(Limits, ThatAreLoweredTakeNothingAwayButGiveNothingNewUntilFewerHold) {
  submit("job", tiles(100, 16));
  std::map<std::string, LeaseDescription> held;
  for (const char* w : {"a", "b", "c"}) held[w] = lease_to(w);
  ASSERT_TRUE(allow("job", 2).status);
  EXPECT_EQ(workers_of("job"), 3);
  EXPECT_EQ(sync("a", {held["a"]}, 2).leases, std::vector{held["a"]}) << "nothing new, but what it has";
  deliver("a", held["a"]);
  EXPECT_EQ(workers_of("job"), 2);
  EXPECT_THAT(sync("a").leases, IsEmpty());
  EXPECT_EQ(sync("b", {held["b"]}, 2).leases.size(), 2u);
  EXPECT_EQ(workers_of("job"), 2);
}

TEST_F(Limits, ThatAreRaisedOrLiftedNotifyIdleWaiters) {
  submit("job", tiles(100, 16), 0, 1);
  lease_to("a");
  for (const char* w : {"b", "c"}) ASSERT_FALSE(sync(w).changed);
  EXPECT_THAT(allow("job", 2).wake, UnorderedElementsAre(WorkerId{"b"}, WorkerId{"c"}));
  EXPECT_TRUE(handle(TopUp{{"b"}}).reply->changed);
  EXPECT_FALSE(handle(TopUp{{"c"}}).reply->changed);
  EXPECT_THAT(allow("job", 0).wake, ElementsAre(WorkerId{"c"}));
  EXPECT_TRUE(handle(TopUp{{"c"}}).reply->changed);
}

TEST_F(Limits, GiveAFreedSlotToAnIdleWorker) {
  submit("job", tiles(100, 16), 0, 1);
  const LeaseDescription lease = lease_to("a");
  ASSERT_FALSE(sync("b").changed);
  // All of its items in two messages: the lease ends with the last item.
  EXPECT_THAT(deliver("a", lease, {lease.items[0]}, false).wake, IsEmpty());
  EXPECT_THAT(deliver("a", lease, {lease.items.begin() + 1, lease.items.end()}, false).wake,
              ElementsAre(WorkerId{"b"}));
  EXPECT_TRUE(handle(TopUp{{"b"}}).reply->changed);
  EXPECT_THAT(sync("a").leases, IsEmpty());
}

// Otherwise one worker would render both jobs, while the other has nothing to do.
TEST_F(Limits, PreferIdleWorkersForASlot) {
  submit("first", tiles(1000, 16), 0, 1);
  submit("second", tiles(1000, 16), 0, 1);
  const Reply both = sync("busy", {}, 2);
  ASSERT_EQ(both.leases.size(), 2u);
  ASSERT_NE(both.leases[0].job, both.leases[1].job);
  ASSERT_FALSE(sync("busy", both.leases, 2).changed);
  ASSERT_FALSE(sync("idle").changed);
  EXPECT_THAT(deliver("busy", both.leases[0]).wake, ElementsAre(WorkerId{"idle"}, WorkerId{"busy"}));
  EXPECT_EQ(handle(TopUp{{"idle"}}).reply->leases[0].job, both.leases[0].job);
  const Reply busy = *handle(TopUp{{"busy"}}).reply;
  for (const LeaseDescription& lease : busy.leases) EXPECT_EQ(lease.job, both.leases[1].job);
}

TEST_F(Limits, GiveTheSlotOfALostWorkerToAnIdleOne) {
  submit("job", tiles(100, 16), 0, 1);
  lease_to("dead");
  pass(seconds(5));
  ASSERT_FALSE(sync("b").changed);
  pass(seconds(5));
  EXPECT_THAT(handle(Tick{}).wake, ElementsAre(WorkerId{"b"}));
  EXPECT_TRUE(handle(TopUp{{"b"}}).reply->changed);
}

TEST_F(Limits, HoldForLeasesFromBeforeARestart) {
  submit("job", tiles(100, 16), 0, 2);
  const LeaseDescription a = lease_to("a"), b = lease_to("b");
  restart();
  EXPECT_EQ(job("job").max_workers, 2u);
  EXPECT_EQ(sync("a", {a}).leases, std::vector{a});
  lease_to("new");
  const Reply late = sync("b", {b});
  EXPECT_THAT(late.leases, IsEmpty());
  EXPECT_TRUE(late.changed);
  EXPECT_THAT(deliver("b", b).verdicts, testing::Each(Verdict::kAccepted)) << "what it has rendered counts";
}

// A worker that renders alone need not leave half of the rest to workers that may not help.
TEST_F(Limits, CountInTheSizesOfLeasesNearTheEnd) {
  const auto samples_of = [this](std::uint32_t max_workers) {
    scheduler_ = std::make_unique<Scheduler>(options_);
    submit("job", tiles(100, 4), 0, max_workers);
    for (int w = 0; w < 20; ++w) sync("idle" + std::to_string(w), {}, 0);
    const LeaseDescription first = lease_to("w");
    deliver("w", first, first.items, true, static_cast<double>(first.items.size() * kTilePixels) / 1e6);
    return lease_to("w").items.size();
  };
  EXPECT_EQ(samples_of(1), kMaxItemsPerLease);
  EXPECT_LT(samples_of(0), kMaxItemsPerLease);
}

TEST_F(Limits, LeaveAPlaceThatAWorkerCannotUseToOneThatHasNotTried) {
  submit("job", tiles(100, 16), 0, 1);
  LeaseDescription lease = lease_to("first");
  for (const char* w : {"second", "third"}) ASSERT_FALSE(sync(w).changed);
  std::vector<std::string> asked;
  for (const char* w : {"first", "second"}) {
    ASSERT_FALSE(sync(w, {lease}).changed);
    const Actions refused = handle(SubmitResult{{w}, lease.job, lease.id, {}, 0, true, "not enough memory"});
    ASSERT_EQ(refused.wake.size(), 3u);
    asked.push_back(refused.wake.front().value);
    EXPECT_EQ(refused.wake.back(), WorkerId{w});
    lease = handle(TopUp{refused.wake.front()}).reply->leases.at(0);
    for (const WorkerId& other : refused.wake) {
      if (other == refused.wake.front()) continue;
      EXPECT_TRUE(handle(TopUp{other}).reply->leases.empty());
    }
    ASSERT_FALSE(sync(w).changed);
    pass(seconds(1));
  }
  EXPECT_THAT(asked, ElementsAre("second", "third"));
}

TEST_F(Limits, ReturnASlotToItsWorkerIfNoOtherIsIdle) {
  submit("job", tiles(100, 16), 0, 1);
  const LeaseDescription lease = lease_to("only");
  handle(SubmitResult{{"only"}, lease.job, lease.id, {}, 0, true, "not enough memory"});
  EXPECT_EQ(lease_to("only").job, JobId{"job"});
}

}  // namespace
}  // namespace tessera::scheduler
