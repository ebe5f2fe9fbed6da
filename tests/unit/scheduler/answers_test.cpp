// SPDX-License-Identifier: Apache-2.0
// Leases that a worker is given with the answer to a result, while its Synchronize waits.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<LeaseId> ids(const std::vector<LeaseDescription>& leases) {
  std::vector<LeaseId> ids;
  for (const LeaseDescription& lease : leases) ids.push_back(lease.id);
  return ids;
}

class Answers : public FarmOfSmallLeases {
 protected:
  // The worker holds two leases, and its call waits.
  std::vector<LeaseDescription> hold_two(const std::string& worker) {
    std::vector<LeaseDescription> leases = sync(worker, {}, 2).leases;
    EXPECT_EQ(leases.size(), 2u);
    EXPECT_FALSE(sync(worker, leases, 2).changed);
    return leases;
  }
  Actions deliver_holding(const std::string& worker, const LeaseDescription& lease, std::vector<LeaseId> held,
                          bool finished = true) {
    const std::vector<WorkItem> items = finished ? lease.items : std::vector<WorkItem>{};
    return handle(
        SubmitResult{{worker}, lease.job, lease.id, items, 0.25, finished, {}, {}, std::move(held)});
  }
  Reply top_up(const std::string& worker) { return *handle(TopUp{{worker}}).reply; }
};

TEST_F(Answers, BringTheNextLease) {
  submit("job", tiles(100, 4));
  const auto held = hold_two("w");
  const Actions actions = deliver_holding("w", held[0], {held[1].id});
  ASSERT_TRUE(actions.reply);
  EXPECT_TRUE(actions.reply->changed);
  EXPECT_THAT(actions.wake, IsEmpty()) << "its call waits on";
  ASSERT_EQ(actions.reply->leases.size(), 2u);
  EXPECT_EQ(actions.reply->leases[0], held[1]);
  const LeaseDescription next = actions.reply->leases[1];
  EXPECT_FALSE(top_up("w").changed);
  EXPECT_FALSE(sync("w", {held[1], next}, 2).changed);
}

TEST_F(Answers, AreEmptyForUnchangedLeases) {
  submit("job", tiles(100, 4));
  const auto held = hold_two("w");
  const Actions actions = deliver_holding("w", held[0], {});
  EXPECT_FALSE(actions.reply);
  EXPECT_THAT(actions.wake, ElementsAre(WorkerId{"w"}));
  EXPECT_EQ(top_up("w").leases.size(), 2u);
}

TEST_F(Answers, AreNoneWhileNoCallWaits) {
  submit("job", tiles(100, 4));
  const auto held = sync("w", {}, 2).leases;  // it has not synchronised again
  EXPECT_FALSE(deliver_holding("w", held[0], {held[1].id}).reply);
  EXPECT_EQ(sync("w", {held[1]}, 2).leases.size(), 2u);
}

TEST_F(Answers, AreNoneWhileTheLeaseGoesOn) {
  submit("job", tiles(100, 4));
  const auto held = hold_two("w");
  const Actions actions = deliver_holding("w", held[0], {held[1].id}, false);
  EXPECT_FALSE(actions.reply);
  EXPECT_THAT(actions.wake, IsEmpty());
}

// Its Synchronize must tell it first.
TEST_F(Answers, AreEmptyForUnknownLeases) {
  submit("a", tiles(2, 1));
  submit("b", tiles(100, 4));
  const auto held = hold_two("w");
  ASSERT_EQ(held[0].job, JobId{"a"});
  ASSERT_EQ(held[1].job, JobId{"b"});
  handle(CancelJob{{"b"}});
  EXPECT_FALSE(deliver_holding("w", held[0], {held[1].id}).reply);
  const Reply told = top_up("w");
  ASSERT_EQ(told.leases.size(), 1u) << "the other tile of a";
  EXPECT_EQ(told.leases[0].job, JobId{"a"});
}

TEST_F(Answers, KeepTheCallWaitingForWork) {
  submit("job", tiles(2, 1));
  const auto held = hold_two("w");
  const Actions actions = deliver_holding("w", held[0], {held[1].id});
  ASSERT_TRUE(actions.reply);
  EXPECT_FALSE(actions.reply->changed) << "there is nothing more to give";
  EXPECT_THAT(handle(SubmitJob{{"next"}, tiles(2, 4), 0}).wake, ElementsAre(WorkerId{"w"}));
  EXPECT_EQ(top_up("w").leases.size(), 2u);
}

TEST_F(Answers, ReportARevokedLease) {
  submit("job", tiles(100, 4));
  const auto held = hold_two("w");
  deliver_holding("w", held[0], {held[1].id});
  EXPECT_THAT(handle(CancelJob{{"job"}}).wake, ElementsAre(WorkerId{"w"}));
  EXPECT_TRUE(top_up("w").changed);
}

TEST_F(Answers, ThatAreLostAreSaidAgainToTheNextCall) {
  submit("job", tiles(100, 4));
  const auto held = hold_two("w");
  const auto told = ids(deliver_holding("w", held[0], {held[1].id}).reply->leases);
  const Reply reply = sync("w", {held[1]}, 2);
  EXPECT_TRUE(reply.changed);
  EXPECT_EQ(ids(reply.leases), told);
}

// It has no room for another lease, but has not received this one.
TEST_F(Answers, ThatAreLostAreSaidAgainToTheDeliveryThatIsRepeated) {
  submit("job", tiles(100, 4));
  const auto held = hold_two("w");
  const auto told = ids(deliver_holding("w", held[0], {held[1].id}).reply->leases);
  const Actions again = deliver_holding("w", held[0], {held[1].id});
  ASSERT_TRUE(again.reply);
  EXPECT_TRUE(again.reply->changed);
  EXPECT_EQ(ids(again.reply->leases), told);
}

// A lost answer had told it of a lease that has ended, so its message cannot name the lease.
TEST_F(Answers, AreEmptyForWorkersThatLostTheirLeases) {
  submit("a", tiles(100, 4));
  submit("b", tiles(100, 4), 1);
  handle(PauseJob{{"b"}});
  const auto held = hold_two("w");
  handle(ResumeJob{{"b"}});
  const auto told = deliver_holding("w", held[0], {held[1].id}).reply->leases;
  ASSERT_EQ(told.at(1).job, JobId{"b"});
  handle(CancelJob{{"b"}});
  const Actions again = deliver_holding("w", held[0], {held[1].id});
  EXPECT_FALSE(again.reply);
  EXPECT_TRUE(top_up("w").changed);
}

// Idle workers come first.
TEST_F(Answers, AreNoneWhileAnIdleWorkerWaitsForWhatBecomesFree) {
  submit("large", tiles(100, 4));
  submit("one", tiles(2, 1), 1, 1);  // its limit is one worker
  const auto held = hold_two("w");
  ASSERT_EQ(held[0].job, JobId{"one"});
  ASSERT_EQ(held[1].job, JobId{"one"});
  handle(PauseJob{{"large"}});
  EXPECT_FALSE(sync("idle").changed);
  // It gives one back unrendered, and keeps its place with the other.
  Actions actions = handle(SubmitResult{{"w"}, {"one"}, held[0].id, {}, 0, true, "", {}, {held[1].id}});
  EXPECT_FALSE(actions.reply);
  EXPECT_THAT(actions.wake, ElementsAre(WorkerId{"idle"}, WorkerId{"w"}));
}

// A lease that a worker was told with the answer to a result counts as received.
TEST_F(Answers, CountAStrikeForLeasesOfALostWorker) {
  submit("job", tiles(100, 4));
  const auto held = hold_two("w");
  const LeaseDescription told = deliver_holding("w", held[0], {held[1].id}).reply->leases.at(1);
  pass(seconds(10));
  tick();
  // The poison tracker leases suspected items alone, one after the other.
  std::vector<WorkItem> alone;
  for (std::size_t i = 0; i < held[1].items.size() + told.items.size(); ++i) {
    const Reply reply = sync("v", {}, 2);
    ASSERT_EQ(reply.leases.size(), 1u);
    alone.insert(alone.end(), reply.leases[0].items.begin(), reply.leases[0].items.end());
    deliver("v", reply.leases[0]);
  }
  std::vector<WorkItem> poison = held[1].items;
  poison.insert(poison.end(), told.items.begin(), told.items.end());
  EXPECT_EQ(alone, poison);
  EXPECT_EQ(sync("v", {}, 2).leases.size(), 2u);
}

TEST_F(Answers, GiveNothingThatMustBeLeasedAlone) {
  submit("job", tiles(4, 1));
  const LeaseDescription deadly = lease_to("dies");
  sync("dies", {deadly});
  const auto held = hold_two("w");
  while (sync("x").leases.size() == 1 && job("job").active_workers < 3) {
  }
  pass(seconds(9));
  sync("w", held, 2);
  pass(seconds(1));
  tick();
  const Actions actions = deliver_holding("w", held[0], {held[1].id});
  ASSERT_TRUE(actions.reply);
  EXPECT_EQ(ids(actions.reply->leases), ids({held[1]})) << "only suspects are left";
  EXPECT_THAT(deliver_holding("w", held[1], {}).wake, ElementsAre(WorkerId{"w"}));
  EXPECT_EQ(top_up("w").leases.size(), 1u);
}

}  // namespace
}  // namespace tessera::scheduler
