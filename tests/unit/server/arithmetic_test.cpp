// SPDX-License-Identifier: Apache-2.0
// Workers and results with different determinism fingerprints.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

class ArithmeticOf : public ScriptedFarm {};

TEST_F(ArithmeticOf, SamplesOfAnotherArithmeticAreRefused) {
  const std::string id = submit();
  v1::SubmitResultRequest request = delivery('a', synchronize(greeting('a')).leases(0));
  request.set_determinism_fingerprint("beef");
  EXPECT_EQ(coordinator().dispatcher().submit_result(request).error().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(job(id).samples_done(), 0u);
  request.set_determinism_fingerprint("f00d");
  EXPECT_GT(deliver(request).accepted_items(), 0u);
}

TEST_F(ArithmeticOf, AWorkerThatComputesOtherBitsIsRefusedByBothFingerprints) {
  submit();
  synchronize(greeting('a'));
  v1::SynchronizeRequest stranger = greeting('b');
  stranger.set_determinism_fingerprint("beef");
  const WaitingCall call(coordinator(), stranger);
  ASSERT_TRUE(call.answered());
  ASSERT_FALSE(call.answer());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(call.answer().error().message, HasSubstr("its fingerprint is beef, the farm's is f00d"));
}

// The first worker does not determine the fingerprint.
TEST_F(ArithmeticOf, AFarmIsThatOfItsCoordinator) {
  submit();
  v1::SynchronizeRequest stranger = greeting('b');
  stranger.set_determinism_fingerprint("beef");
  const WaitingCall call(coordinator(), stranger);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(call.answer().error().message, HasSubstr("--accept-fingerprint beef"));
  EXPECT_EQ(synchronize(greeting('a')).leases_size(), 1);
}

TEST_F(ArithmeticOf, ADoneJobOfAnotherArithmeticCannotBeContinued) {
  const std::string done = submit();
  work('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  fingerprints_ = {"beef"};
  open();
  EXPECT_EQ(job(done).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(coordinator().jobs().extend(done, kSpp + 1).error().code, ErrorCode::kFailedPrecondition);
}

// Its samples are kept for a coordinator whose workers can continue it.
TEST_F(ArithmeticOf, AnUnfinishedJobOfAnotherArithmeticWaitsForItsFarm) {
  const std::string id = submit();
  work('a', 1);
  const std::uint64_t done = job(id).samples_done();
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  fingerprints_ = {"beef"};
  open();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(job(id).failure(), HasSubstr("--accept-fingerprint f00d"));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  fingerprints_ = {kFingerprint};
  open();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  EXPECT_EQ(job(id).samples_done(), done);
}

// A job belongs to the fingerprint of its first samples, and other workers render other jobs.
TEST_F(ArithmeticOf, AFarmOfTwoFingerprintsRendersEachJobWithOne) {
  fingerprints_ = {kFingerprint, "beef"};
  open();
  const auto greeting_of = [](char worker, const std::string& fingerprint) {
    v1::SynchronizeRequest request = greeting(worker);
    request.set_determinism_fingerprint(fingerprint);
    return request;
  };
  const std::string first = submit();
  work('a', 1);
  const WaitingCall other(coordinator(), greeting_of('b', "beef"));
  EXPECT_FALSE(other.answered()) << "the only job belongs to the other fingerprint";
  const std::string second = submit();
  ASSERT_TRUE(other.answered());
  const v1::Lease lease = other.answer()->leases(0);
  EXPECT_EQ(lease.job_id(), second);
  deliver(delivery('b', lease));
  EXPECT_GT(job(second).samples_done(), 0u);
  work('a');
  EXPECT_EQ(job(first).samples_done(), kSamples);
  EXPECT_LT(job(second).samples_done(), kSamples);

  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  EXPECT_FALSE(WaitingCall(coordinator(), greeting('a')).answered()) << "also after a restart";
  EXPECT_EQ(synchronize(greeting_of('b', "beef")).leases_size(), 1);
}

}  // namespace
}  // namespace tessera::server
