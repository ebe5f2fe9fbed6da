// SPDX-License-Identifier: Apache-2.0
// Calls that wait until there is a change.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class Waiting : public FarmOfSmallLeases {
 protected:
  Reply top_up(const std::string& worker) { return *handle(TopUp{{worker}}).reply; }
};

TEST_F(Waiting, IsWhatAWorkerDoesThatCanBeGivenNothing) {
  EXPECT_FALSE(sync("w").changed);
  submit("busy", tiles(100, 4));
  const LeaseDescription lease = lease_to("v");
  EXPECT_FALSE(sync("v", {lease}).changed);
}

TEST_F(Waiting, EndsWhenAJobIsSubmitted) {
  sync("w");
  EXPECT_THAT(handle(SubmitJob{{"job"}, tiles(2, 4), 0}).wake, ElementsAre(WorkerId{"w"}));
  const Reply reply = top_up("w");
  EXPECT_EQ(reply.leases.size(), 1u);
  EXPECT_TRUE(reply.changed);
}

TEST_F(Waiting, GoesOnWhenOthersHaveTakenTheWork) {
  submit("job", tiles(2, 1));
  handle(PauseJob{{"job"}});
  for (const char* w : {"a", "b", "c", "d", "e"}) sync(w);
  EXPECT_EQ(handle(ResumeJob{{"job"}}).wake.size(), 5u);
  for (const char* w : {"a", "b", "c", "d"}) EXPECT_TRUE(top_up(w).changed) << w;  // two ranges, two copies
  EXPECT_FALSE(top_up("e").changed);
  // "e" is waiting again.
  EXPECT_THAT(handle(SubmitJob{{"next"}, tiles(2, 4), 0}).wake, ElementsAre(WorkerId{"e"}));
}

TEST_F(Waiting, EndsWhenALeaseRunsOut) {
  submit("job", tiles(2, 1));
  for (const char* w : {"a", "b"}) lease_to(w);
  pass(seconds(5));
  for (const char* w : {"c", "d"}) lease_to(w);
  EXPECT_FALSE(sync("idle").changed);
  pass(seconds(5));
  EXPECT_THAT(handle(Tick{}).wake, ElementsAre(WorkerId{"idle"}));
  EXPECT_TRUE(top_up("idle").changed);
}

TEST_F(Waiting, EndsWhenWhatTheWorkerHoldsIsTakenFromIt) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("w");
  ASSERT_FALSE(sync("w", {lease}).changed);
  EXPECT_THAT(handle(CancelJob{{"job"}}).wake, ElementsAre(WorkerId{"w"}));
  const Reply reply = top_up("w");
  EXPECT_THAT(reply.leases, IsEmpty());
  EXPECT_TRUE(reply.changed);
}

TEST_F(Waiting, EndsWhenTheWorkerHasDeliveredALease) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("w");
  ASSERT_FALSE(sync("w", {lease}).changed);
  EXPECT_THAT(deliver("w", lease).wake, ElementsAre(WorkerId{"w"}));
  EXPECT_TRUE(top_up("w").changed);
}

TEST_F(Waiting, EndsInOrderOfArrival) {
  for (const char* worker : {"z", "m", "a"}) sync(worker);
  const Actions actions = handle(SubmitJob{{"job"}, tiles(100, 16), 0});
  EXPECT_THAT(actions.wake, testing::ElementsAre(WorkerId{"z"}, WorkerId{"m"}, WorkerId{"a"}));
}

TEST_F(Waiting, IsNoSignOfLife) {
  submit("job", tiles(100, 4));
  const LeaseDescription first = lease_to("w");
  sync("w", {first});
  pass(seconds(7));
  deliver("w", first);
  const Reply reply = top_up("w");
  ASSERT_EQ(reply.leases.size(), 1u);
  EXPECT_EQ(reply.heartbeat_timeout, seconds(3));
  pass(seconds(3));
  tick();
  EXPECT_EQ(job("job").active_workers, 0);
}

TEST_F(Waiting, DoesNotNotifyFullWorkers) {
  submit("job", tiles(100, 4));
  const LeaseDescription lease = lease_to("full");
  sync("full", {lease}, 1);
  sync("leaving", {}, 4, true);
  EXPECT_THAT(handle(SubmitJob{{"next"}, tiles(2, 4), 0}).wake, IsEmpty());
}

TEST_F(Waiting, DoesNotNotifySupersededCalls) {
  sync("w", {}, 1);
  sync("w", {}, 0);
  EXPECT_THAT(handle(SubmitJob{{"job"}, tiles(2, 4), 0}).wake, IsEmpty());
}

TEST_F(Waiting, NotifiesEachCallOnce) {
  sync("w");
  EXPECT_EQ(handle(SubmitJob{{"a"}, tiles(2, 4), 0}).wake.size(), 1u);
  EXPECT_THAT(handle(SubmitJob{{"b"}, tiles(2, 4), 0}).wake, IsEmpty());
}

TEST_F(Waiting, IsNotExtendedForALostWorker) {
  EXPECT_EQ(handle(TopUp{{"nobody"}}).status.error().code, core::ErrorCode::kNotFound);
  submit("job", tiles(100, 4));
  sync("w", {}, 0);
  pass(seconds(10));
  EXPECT_EQ(handle(TopUp{{"w"}}).status.error().code, core::ErrorCode::kNotFound);
}

}  // namespace
}  // namespace tessera::scheduler
