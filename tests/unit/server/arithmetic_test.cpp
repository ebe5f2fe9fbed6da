// Workers and results of different arithmetic.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::coordinator {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

class ArithmeticOf : public ScriptedFarm {};

TEST_F(ArithmeticOf, SamplesOfAnotherArithmeticAreRefused) {
  const std::string id = submit();
  v1::SubmitResultRequest request = delivery('a', synchronize(greeting('a')).leases(0));
  request.set_arithmetic_fingerprint("beef");
  EXPECT_EQ(coordinator().submit_result(request).error().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(job(id).samples_done(), 0u);
  request.set_arithmetic_fingerprint("f00d");
  EXPECT_GT(deliver(request).accepted_items(), 0u);
}

TEST_F(ArithmeticOf, AWorkerThatComputesOtherBitsIsRefusedByBothFingerprints) {
  submit();
  synchronize(greeting('a'));
  v1::SynchronizeRequest stranger = greeting('b');
  stranger.set_arithmetic_fingerprint("beef");
  const WaitingCall call(coordinator(), stranger);
  ASSERT_TRUE(call.answered());
  ASSERT_FALSE(call.answer());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(call.answer().error().message, HasSubstr("its fingerprint is beef, the farm's is f00d"));
}

TEST_F(ArithmeticOf, AnotherArithmeticMayTakeOverWhenNothingOfTheOldOneIsLeft) {
  const std::string done = submit();
  work('a');
  now_ += std::chrono::seconds(11);  // the old worker is gone
  coordinator().tick();
  v1::SynchronizeRequest successor = greeting('b');
  successor.set_arithmetic_fingerprint("beef");
  submit();
  EXPECT_EQ(synchronize(successor).leases_size(), 1);
  // But what the old one began cannot be continued.
  EXPECT_EQ(coordinator().extend_job(done, kSpp + 1).error().code, ErrorCode::kFailedPrecondition);
}

TEST_F(ArithmeticOf, AnUnfinishedJobKeepsItsArithmeticAcrossARestart) {
  submit();
  work('a', 1);
  ASSERT_TRUE(coordinator().checkpoint());
  open();
  v1::SynchronizeRequest stranger = greeting('b');
  stranger.set_arithmetic_fingerprint("beef");
  const WaitingCall call(coordinator(), stranger);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kFailedPrecondition);
}

}  // namespace
}  // namespace tessera::coordinator
