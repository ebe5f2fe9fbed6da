// SPDX-License-Identifier: Apache-2.0
// Leases: who is granted which samples, for how long, and how leases end.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using Leases = Farm;
using Copies = FarmOfSmallLeases;

TEST_F(Leases, AWorkerIsGivenTheFirstSamplesOfTheFirstTiles) {
  submit("job", tiles(100, 16));
  const Reply reply = sync("w");
  ASSERT_EQ(reply.leases.size(), 1u);
  EXPECT_EQ(reply.leases[0].job, JobId{"job"});
  EXPECT_EQ(reply.leases[0].items,
            (std::vector<WorkItem>{{0, {0, 1}}, {1, {0, 1}}, {2, {0, 1}}, {3, {0, 1}}}));
  EXPECT_TRUE(reply.changed);
  EXPECT_EQ(reply.heartbeat_timeout, seconds(10));
}

TEST_F(Leases, TwoWorkersAreGivenDifferentWork) {
  submit("job", tiles(100, 16));
  EXPECT_EQ(lease_to("a").items.back(), (WorkItem{3, {0, 1}}));
  EXPECT_EQ(lease_to("b").items.front(), (WorkItem{4, {0, 1}}));
}

TEST_F(Leases, NothingIsGivenWhereNothingIsToDo) {
  const Reply reply = sync("w");
  EXPECT_TRUE(reply.leases.empty());
  EXPECT_FALSE(reply.changed);
}

TEST_F(Leases, AWorkerHoldsAsManyAsItWantsUpToFour) {
  submit("job", tiles(100, 16));
  EXPECT_EQ(sync("modest", {}, 2).leases.size(), 2u);
  EXPECT_EQ(sync("greedy", {}, 100).leases.size(), 4u);
  EXPECT_EQ(sync("shy", {}, 0).leases.size(), 0u);
}

TEST_F(Leases, IdsAreNeverRepeatedAndBeginWithTheEpoch) {
  submit("job", tiles(100, 16));
  EXPECT_EQ(lease_to("a").id.value, (std::uint64_t{1} << 40) + 1);
  EXPECT_EQ(lease_to("b").id.value, (std::uint64_t{1} << 40) + 2);
  restart();
  EXPECT_EQ(lease_to("a").id.value, (std::uint64_t{2} << 40) + 1);
}

TEST_F(Leases, AreSizedToTheMeasuredSpeed) {
  submit("job", tiles(4000, 4096));
  const LeaseDescription first = lease_to("w");
  deliver("w", first, first.items, true, 4 * 4096 / 20'000.0);
  std::uint64_t samples = 0;
  for (const WorkItem& item : lease_to("w").items) samples += item.samples.count() * kTilePixels;
  EXPECT_EQ(samples, 10 * kTilePixels);  // 40,000, rounded up to whole tiles
}

TEST_F(Leases, HaveNoMoreThan32ItemsHoweverFastTheWorker) {
  submit("job", tiles(400, 16));
  const LeaseDescription first = lease_to("w");
  deliver("w", first, first.items, true, 1e-6);
  EXPECT_EQ(lease_to("w").items.size(), kMaxItemsPerLease);
}

TEST_F(Leases, CutPassesThatAreLongForASlowWorker) {
  submit("job", tiles(2, 1024));
  Reply reply = sync("w");
  for (int i = 0; i < 40; ++i) {
    deliver("w", reply.leases[0], reply.leases[0].items, true,
            static_cast<double>(kTilePixels * reply.leases[0].items[0].samples.count()) / 10'000);
    reply = sync("w");
  }
  // 20,000 pixel samples are about five samples of a tile.
  const core::SampleRange samples = reply.leases[0].items[0].samples;
  EXPECT_GT(samples.begin, 32u);
  EXPECT_LE(samples.count(), 5u);
}

TEST_F(Leases, AreKeptWhileTheWorkerReportsThem) {
  submit("job", tiles(100, 16));
  const LeaseDescription lease = lease_to("w");
  for (int i = 0; i < 10; ++i) {
    pass(seconds(9));
    const Reply reply = sync("w", {lease});
    EXPECT_EQ(reply.leases, std::vector{lease});
    EXPECT_FALSE(reply.changed);
  }
}

TEST_F(Leases, OfALostWorkerAreReassignedToOthers) {
  submit("job", tiles(100, 16));
  const LeaseDescription lost = lease_to("silent");
  sync("silent", {lost});
  EXPECT_EQ(scheduler_->next_deadline(), now_ + seconds(10));
  pass(seconds(10) - milliseconds(1));
  tick();
  EXPECT_EQ(job("job").active_workers, 1);
  pass(milliseconds(1));
  tick();
  EXPECT_EQ(job("job").active_workers, 0);
  EXPECT_EQ(lease_to("other").items, std::vector{lost.items[0]}) << "alone: the worker may have died of it";
}

TEST_F(Leases, ExpireAtTheNextEvent) {
  submit("job", tiles(100, 16));
  const LeaseDescription lost = lease_to("silent");
  sync("silent", {lost});
  pass(seconds(10));
  EXPECT_EQ(lease_to("other").items, std::vector{lost.items[0]});
}

TEST_F(Leases, AreSentAgainIfTheReplyMayHaveBeenLost) {
  submit("job", tiles(100, 16));
  const LeaseDescription lease = lease_to("w");
  const Reply again = sync("w");
  EXPECT_EQ(again.leases, std::vector{lease});
  EXPECT_TRUE(again.changed);
}

TEST_F(Leases, AreEndedWhenTheWorkerReportsThemNoMore) {
  submit("job", tiles(100, 16));
  const LeaseDescription dropped = lease_to("w");
  sync("w", {dropped});
  const LeaseDescription next = lease_to("w");
  EXPECT_NE(next.id, dropped.id);
  EXPECT_EQ(next.items, dropped.items);
}

TEST_F(Leases, OfADrainingWorkerAreNotReplaced) {
  submit("job", tiles(100, 16));
  const LeaseDescription lease = lease_to("w");
  EXPECT_EQ(sync("w", {lease}, 4, true).leases, std::vector{lease});
  EXPECT_TRUE(sync("w", {}, 4, true).leases.empty());
  EXPECT_EQ(lease_to("other").items, lease.items);
}

TEST_F(Leases, NotYetAcknowledgedByADrainingWorkerAreReassignedAtOnce) {
  submit("job", tiles(100, 16));
  const LeaseDescription unheard = lease_to("w");
  EXPECT_TRUE(sync("w", {}, 1, true).leases.empty());
  EXPECT_EQ(lease_to("other").items, unheard.items);
}

TEST_F(Leases, OfAReturningWorkerAreRestoredIfFree) {
  submit("job", tiles(100, 16));
  const LeaseDescription lease = lease_to("w");
  pass(seconds(30));
  tick();
  EXPECT_EQ(sync("w", {lease}).leases, std::vector{lease});
}

TEST_F(Leases, OfAReturningWorkerAreRestoredAsFarAsTheyAreFree) {
  submit("job", tiles(100, 16));
  LeaseDescription lease = lease_to("w");
  pass(seconds(30));
  const LeaseDescription taken = lease_to("other");
  ASSERT_EQ(taken.items, lease.items);
  const Reply back = sync("w", {lease});
  ASSERT_EQ(back.leases.size(), 1u);
  EXPECT_NE(back.leases[0].id, lease.id);
  EXPECT_EQ(back.leases[0].items.front(), (WorkItem{4, {0, 1}}));
}

TEST_F(Leases, ThatWereNeverGrantedAreRejected) {
  submit("job", tiles(100, 16));
  const LeaseDescription invented{LeaseId{(std::uint64_t{9} << 40) + 1}, {"job"}, {{0, {0, 16}}}};
  EXPECT_TRUE(sync("liar", {invented}, 0).leases.empty());
}

TEST_F(Leases, OfAnotherWorkerAreNotBelieved) {
  submit("job", tiles(100, 16));
  const LeaseDescription lease = lease_to("holder");
  EXPECT_TRUE(sync("liar", {lease}, 0).leases.empty());
  EXPECT_EQ(sync("holder", {lease}).leases, std::vector{lease});
}

TEST_F(Copies, GoToIdleWorkersWhenNothingIsFree) {
  submit("job", tiles(2, 1));
  const LeaseDescription first = lease_to("a"), second = lease_to("b");
  const LeaseDescription copy = lease_to("c");
  EXPECT_EQ(copy.items, first.items) << "the oldest first";
  EXPECT_NE(copy.id, first.id);
  EXPECT_EQ(lease_to("d").items, second.items);
  EXPECT_TRUE(sync("e").leases.empty()) << "two holders are enough";
}

TEST_F(Copies, AreNotMadeWhileThereIsFreeWork) {
  submit("job", tiles(8, 1));
  const LeaseDescription first = lease_to("a"), second = lease_to("b");
  for (const WorkItem& item : second.items) EXPECT_THAT(first.items, testing::Not(testing::Contains(item)));
}

TEST_F(Copies, AreNotMadeForBusyWorkers) {
  submit("job", tiles(2, 1));
  const LeaseDescription mine = lease_to("a");
  lease_to("b");
  EXPECT_EQ(sync("a", {mine}, 2).leases, std::vector{mine});
}

TEST_F(Copies, ThatAreDeliveredFirstEndTheirOriginals) {
  submit("job", tiles(2, 1));
  const LeaseDescription first = lease_to("slow");
  lease_to("other");
  const LeaseDescription copy = lease_to("quick");
  ASSERT_EQ(copy.items, first.items);
  sync("slow", {first});
  deliver("quick", copy);
  const Reply reply = sync("slow", {first}, 0);
  EXPECT_TRUE(reply.leases.empty());
  EXPECT_TRUE(reply.changed);
}

TEST_F(Leases, OfWhichAnotherHasDeliveredAPartAreTakenBackInThatPartAtOnce) {
  submit("job", tiles(4, 1));
  const LeaseDescription original = lease_to("slow");
  ASSERT_EQ(original.items.size(), 2u);
  deliver("quick", lease_to("quick"));
  const LeaseDescription copy = lease_to("quick");
  ASSERT_EQ(copy.items, std::vector{original.items[0]});
  ASSERT_FALSE(sync("slow", {original}).changed);
  const Actions actions = deliver("quick", copy);
  EXPECT_THAT(actions.wake, testing::Contains(WorkerId{"slow"}));
  const Reply reply = *handle(TopUp{{"slow"}}).reply;
  EXPECT_TRUE(reply.changed);
  ASSERT_EQ(reply.leases.size(), 1u);
  EXPECT_EQ(reply.leases[0].items, std::vector{original.items[1]});
  EXPECT_FALSE(sync("slow", reply.leases).changed);
}

TEST_F(Copies, KeepARangeLeasedWhileAHolderRemains) {
  submit("job", tiles(2, 1));
  const LeaseDescription a = lease_to("a"), b = lease_to("b");
  pass(seconds(5));
  const LeaseDescription copy = lease_to("c");
  ASSERT_EQ(copy.items, a.items);
  pass(seconds(5));
  tick();
  EXPECT_EQ(job("job").active_workers, 1);
  EXPECT_EQ(lease_to("d").items, b.items);  // free again, while those of c can only be copied
  EXPECT_EQ(lease_to("e").items, a.items);
}

TEST_F(Leases, LostWorkersAreListedForAWhile) {
  submit("job", tiles(100, 16));
  lease_to("w");
  pass(seconds(10));
  tick();
  ASSERT_EQ(scheduler_->workers(now_).size(), 1u);
  EXPECT_TRUE(scheduler_->workers(now_)[0].silent);
  EXPECT_EQ(scheduler_->workers(now_)[0].held_leases, 0);
  EXPECT_EQ(scheduler_->next_deadline(), now_ + seconds(90));
  pass(seconds(90));
  tick();
  EXPECT_TRUE(scheduler_->workers(now_).empty());
  EXPECT_EQ(scheduler_->next_deadline(), std::nullopt);
}

TEST_F(Leases, SurviveAClockThatGoesBackwards) {
  submit("job", tiles(100, 16));
  pass(seconds(100));
  const LeaseDescription lease = lease_to("w");
  now_ -= seconds(50);
  EXPECT_EQ(sync("w", {lease}).leases, std::vector{lease});
  EXPECT_EQ(scheduler_->next_deadline(), now_ + seconds(60));
}

TEST_F(Leases, AndWorkersExpireAfterAClockJump) {
  submit("job", tiles(100, 16));
  const LeaseDescription lost = lease_to("w");
  pass(std::chrono::hours(24));
  tick();
  EXPECT_TRUE(scheduler_->workers(now_).empty());
  EXPECT_EQ(lease_to("other").items, lost.items);
}

}  // namespace
}  // namespace tessera::scheduler
