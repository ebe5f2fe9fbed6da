// Calls of Synchronize that wait.
#include <gtest/gtest.h>

#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::coordinator {
namespace {

using core::ErrorCode;
using std::chrono::milliseconds;
using std::chrono::seconds;

class Waiting : public ScriptedFarm {};

TEST_F(Waiting, ASubmittedJobWakesThoseWhoWaitForWork) {
  const WaitingCall first(coordinator(), greeting('a')), second(coordinator(), greeting('b'));
  EXPECT_FALSE(first.answered());
  EXPECT_FALSE(second.answered());
  submit();
  ASSERT_TRUE(first.answered() && second.answered());
  EXPECT_EQ(first.answer()->leases_size(), 1);
  EXPECT_EQ(second.answer()->leases_size(), 1);
}

TEST_F(Waiting, EndsWellBeforeTheWorkerMustBeHeardOf) {
  const WaitingCall call(coordinator(), greeting('a'));
  now_ += milliseconds(3300);
  coordinator().tick();
  EXPECT_FALSE(call.answered());
  now_ += milliseconds(100);
  coordinator().tick();
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer()->leases_size(), 0);
}

TEST_F(Waiting, ASecondCallOfTheWorkerEndsTheFirst) {
  const WaitingCall first(coordinator(), greeting('a'));
  const WaitingCall second(coordinator(), greeting('a'));
  EXPECT_TRUE(first.answered());
  EXPECT_FALSE(second.answered());
}

TEST_F(Waiting, AWorkerThatHoldsWhatItShouldWaits) {
  submit();
  v1::SynchronizeRequest request = greeting('a');
  const v1::SynchronizeResponse response = synchronize(request);
  *request.mutable_held() = response.leases();
  request.add_known_job_ids(response.jobs(0).job_id());
  const WaitingCall call(coordinator(), request);
  EXPECT_FALSE(call.answered());
}

TEST_F(Waiting, AWorkerThatLacksTheJobOfItsLeaseIsToldAtOnce) {
  submit();
  v1::SynchronizeRequest request = greeting('a');
  *request.mutable_held() = synchronize(request).leases();
  EXPECT_EQ(synchronize(request).jobs_size(), 1);
}

TEST_F(Waiting, DeliveringALeaseBringsTheNextOne) {
  submit();
  v1::SynchronizeRequest request = greeting('a');
  const v1::SynchronizeResponse response = synchronize(request);
  *request.mutable_held() = response.leases();
  request.add_known_job_ids(response.jobs(0).job_id());
  const WaitingCall call(coordinator(), request);
  deliver(delivery('a', response.leases(0)));
  ASSERT_TRUE(call.answered());
  ASSERT_EQ(call.answer()->leases_size(), 1);
  EXPECT_NE(call.answer()->leases(0).id(), response.leases(0).id());
}

TEST_F(Waiting, CancellingAJobTellsWhoRendersIt) {
  const std::string id = submit();
  v1::SynchronizeRequest request = greeting('a');
  *request.mutable_held() = synchronize(request).leases();
  request.add_known_job_ids(id);
  const WaitingCall call(coordinator(), request);
  ASSERT_TRUE(coordinator().cancel_job(id));
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer()->leases_size(), 0);
}

TEST_F(Waiting, AWorkerThatLeavesAndHoldsNothingIsNotKept) {
  submit();
  v1::SynchronizeRequest request = greeting('a');
  request.set_draining(true);
  EXPECT_EQ(synchronize(request).leases_size(), 0);
}

TEST_F(Waiting, WhoHasHungUpIsLeasedNothing) {
  WaitingCall gone(coordinator(), greeting('a'));
  gone.leave();
  const WaitingCall waiting(coordinator(), greeting('b'));
  submit();
  ASSERT_TRUE(gone.answered() && waiting.answered());
  EXPECT_EQ(gone.answer().error().code, ErrorCode::kCancelled);
  EXPECT_EQ(waiting.answer()->leases_size(), 1);
  const auto workers = coordinator().workers();
  ASSERT_EQ(workers.size(), 2u);
  EXPECT_EQ(workers[0].held_leases(), 0u);
}

TEST_F(Waiting, ClosingAnswersEveryone) {
  const WaitingCall waiting(coordinator(), greeting('a'));
  coordinator().close();
  const WaitingCall late(coordinator(), greeting('b'));
  ASSERT_TRUE(waiting.answered() && late.answered());
  EXPECT_EQ(waiting.answer().error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(late.answer().error().code, ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace tessera::coordinator
