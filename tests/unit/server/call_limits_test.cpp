// SPDX-License-Identifier: Apache-2.0
// Limits of messages and of calls.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "proto/status.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using testing::HasSubstr;

using CallLimits = LimitedService;

TEST_F(CallLimits, OfMessages) {
  start({.message_mib = 1});
  grpc::ClientContext context;
  v1::GetJobRequest request;
  request.set_job_id(std::string(2 << 20, 'x'));
  v1::GetJobResponse response;
  EXPECT_EQ(users_->GetJob(&context, request, &response).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  grpc::ClientContext after;
  EXPECT_TRUE(list(after).ok());
}

TEST_F(CallLimits, OfCallsSayWhenToTryAgain) {
  start({.calls_per_second = 0.5});
  for (int i = 0; i < 100; ++i) {
    grpc::ClientContext context;
    const grpc::Status status = list(context);
    if (status.ok()) continue;
    EXPECT_GE(i, 5) << "ten seconds' worth at once";
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_THAT(
        status.error_message(),
        HasSubstr("there are too many calls from here, and this farm takes at most 0.5 a second from each "
                  "caller (tessera-coordinator --max-calls-per-second)"));
    EXPECT_EQ(proto::error_from_grpc(status, context).code, core::ErrorCode::kUnavailable);
    grpc::ClientContext working;
    v1::SynchronizeResponse response;
    v1::SynchronizeRequest request = greeting_with_key('a');
    request.set_wanted_leases(0);
    request.set_draining(true);
    EXPECT_TRUE(workers_->Synchronize(&working, request, &response).ok()) << "workers count by themselves";
    return;
  }
  FAIL() << "nothing was refused";
}

TEST_F(CallLimits, OfWorkersCallsAsWell) {
  start({.calls_per_second = 0.5});
  for (int i = 0; i < 100; ++i) {
    grpc::ClientContext context;
    v1::SubmitResultRequest request;
    request.set_worker_id("a");
    v1::SubmitResultResponse response;
    const grpc::Status status = workers_->SubmitResult(&context, request, &response);
    if (status.error_code() != grpc::StatusCode::RESOURCE_EXHAUSTED) continue;
    EXPECT_GE(i, 5);
    return;
  }
  FAIL() << "nothing was refused";
}

}  // namespace
}  // namespace tessera::rpc
