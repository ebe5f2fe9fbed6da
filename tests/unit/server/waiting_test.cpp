// SPDX-License-Identifier: Apache-2.0
// Calls of Synchronize that wait.
#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <optional>

#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using std::chrono::milliseconds;
using std::chrono::seconds;

class Waiting : public ScriptedFarm {};

TEST_F(Waiting, ASubmittedJobNotifiesIdleWaiters) {
  const WaitingCall first(coordinator(), greeting('a')), second(coordinator(), greeting('b'));
  EXPECT_FALSE(first.answered());
  EXPECT_FALSE(second.answered());
  submit();
  ASSERT_TRUE(first.answered() && second.answered());
  EXPECT_EQ(first.answer()->leases_size(), 1);
  EXPECT_EQ(second.answer()->leases_size(), 1);
}

TEST_F(Waiting, EndsWellBeforeTheHeartbeatTimeout) {
  const WaitingCall call(coordinator(), greeting('a'));
  now_ += milliseconds(3300);
  coordinator().dispatcher().tick();
  EXPECT_FALSE(call.answered());
  now_ += milliseconds(100);
  coordinator().dispatcher().tick();
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

TEST_F(Waiting, AWorkerWithoutTheJobOfItsLeaseGetsItAtOnce) {
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

class WaitingWithAnswers : public ScriptedFarm {
 protected:
  // Holds two leases of the job, and its call waits.
  v1::SynchronizeRequest hold_two() {
    v1::SynchronizeRequest request = greeting('a');
    request.set_wanted_leases(2);
    const v1::SynchronizeResponse response = synchronize(request);
    EXPECT_EQ(response.leases_size(), 2);
    *request.mutable_held() = response.leases();
    request.add_known_job_ids(response.jobs(0).job_id());
    return request;
  }
  static v1::SubmitResultRequest delivery_holding(const v1::Lease& lease, const v1::Lease& other) {
    v1::SubmitResultRequest request = delivery('a', lease);
    request.add_held_lease_ids(other.id());
    return request;
  }
};

TEST_F(WaitingWithAnswers, ALeaseComesWithTheAnswerToAResult) {
  submit();
  const v1::SynchronizeRequest request = hold_two();
  const WaitingCall call(coordinator(), request);
  const v1::SubmitResultResponse answer = deliver(delivery_holding(request.held(0), request.held(1)));
  EXPECT_FALSE(call.answered());
  EXPECT_EQ(answer.accepted_items(), static_cast<std::uint32_t>(request.held(0).items_size()));
  ASSERT_EQ(answer.new_leases_size(), 1);
  EXPECT_GT(answer.new_leases(0).id(), request.held(1).id());
  EXPECT_GT(answer.new_leases(0).items_size(), 0);
  EXPECT_EQ(answer.jobs_size(), 0) << "it knows the job";
}

TEST_F(WaitingWithAnswers, AJobThatTheWorkerDoesNotKnowComesWithItsLease) {
  submit();
  const v1::SynchronizeRequest request = hold_two();
  const WaitingCall call(coordinator(), request);
  v1::SubmitJobRequest urgent = submission();
  urgent.set_request_id("urgent");
  urgent.set_priority(1);
  const std::string id = submit(urgent);
  const v1::SubmitResultResponse answer = deliver(delivery_holding(request.held(0), request.held(1)));
  ASSERT_EQ(answer.new_leases_size(), 1);
  ASSERT_EQ(answer.jobs_size(), 1);
  EXPECT_EQ(answer.jobs(0).job_id(), id);
  EXPECT_EQ(answer.jobs(0).settings().width_px(), static_cast<std::uint32_t>(kWidthPx));
}

TEST_F(WaitingWithAnswers, TheWholeImageCanComeInThisWay) {
  const std::string id = submit();
  v1::SynchronizeRequest request = hold_two();
  std::deque<v1::Lease> held(request.held().begin(), request.held().end());
  while (held.size() > 1) {
    const WaitingCall call(coordinator(), request);
    const v1::SubmitResultResponse answer = deliver(delivery_holding(held[0], held[1]));
    held.pop_front();
    held.insert(held.end(), answer.new_leases().begin(), answer.new_leases().end());
    *request.mutable_held() = {held.begin(), held.end()};
  }
  deliver(delivery('a', held[0]));
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

// Leases in a message that the worker does not hold get it no others.
TEST_F(WaitingWithAnswers, NamingLeasesThatItDoesNotHoldBringsNone) {
  submit();
  const v1::SynchronizeRequest request = hold_two();
  const WaitingCall call(coordinator(), request);
  v1::SubmitResultRequest result = delivery_holding(request.held(0), request.held(1));
  for (std::uint64_t id = 1; id < 100'000; ++id) result.add_held_lease_ids(id);
  EXPECT_EQ(deliver(result).new_leases_size(), 0);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer()->leases_size(), 2);
}

TEST_F(Waiting, CancellingAJobNotifiesItsWorkers) {
  const std::string id = submit();
  v1::SynchronizeRequest request = greeting('a');
  *request.mutable_held() = synchronize(request).leases();
  request.add_known_job_ids(id);
  const WaitingCall call(coordinator(), request);
  ASSERT_TRUE(coordinator().jobs().cancel(id));
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer()->leases_size(), 0);
}

TEST_F(Waiting, AWorkerThatLeavesAndHoldsNothingIsNotKept) {
  submit();
  v1::SynchronizeRequest request = greeting('a');
  request.set_draining(true);
  EXPECT_EQ(synchronize(request).leases_size(), 0);
}

TEST_F(Waiting, CancelledCallsGetNoLeases) {
  WaitingCall gone(coordinator(), greeting('a'));
  gone.leave();
  const WaitingCall waiting(coordinator(), greeting('b'));
  submit();
  ASSERT_TRUE(gone.answered() && waiting.answered());
  EXPECT_EQ(gone.answer().error().code, ErrorCode::kCancelled);
  EXPECT_EQ(waiting.answer()->leases_size(), 1);
  const auto workers = coordinator().dispatcher().workers();
  ASSERT_EQ(workers.size(), 2u);
  EXPECT_EQ(workers[0].held_leases(), 0u);
}

TEST_F(Waiting, CallsOfCallersThatHaveGoneCanBeRemovedAtOnce) {
  const std::string worker = greeting('a').worker_id();
  WaitingCall call(coordinator(), greeting('a'));
  coordinator().dispatcher().remove_gone(worker);
  EXPECT_FALSE(call.answered());
  call.leave();
  coordinator().dispatcher().remove_gone(worker);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kCancelled);
  coordinator().dispatcher().remove_gone(worker);
}

TEST_F(Waiting, ACallerThatHasGoneBeforeItIsHeardIsNotRegistered) {
  submit();
  std::optional<ErrorCode> answer;
  coordinator().dispatcher().synchronize(
      greeting('a'),
      {.answer = [&](const auto& result) { answer = result.error().code; }, .is_gone = [] { return true; }});
  EXPECT_EQ(answer, ErrorCode::kCancelled);
  EXPECT_TRUE(coordinator().dispatcher().workers().empty());
}

TEST_F(Waiting, ATickLooksAtNoCallThatIsNotDue) {
  const auto looks = std::make_shared<int>(0);
  coordinator().dispatcher().synchronize(
      greeting('a'), {.answer = [](const auto&) {}, .is_gone = [looks] { return ++*looks < 0; }});
  *looks = 0;
  for (int second = 0; second < 3; ++second) {
    now_ += seconds(1);
    coordinator().dispatcher().tick();
  }
  EXPECT_EQ(*looks, 0);
  now_ += seconds(1);
  coordinator().dispatcher().tick();
  EXPECT_EQ(*looks, 1) << "it is due";
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
}  // namespace tessera::server
