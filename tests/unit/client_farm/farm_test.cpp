// How commands speak to a coordinator that refuses them: when they wait, and when they do not.
#include "client/farm/farm.hpp"

#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>

#include "proto/status.hpp"

namespace tessera::client {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

// Refuses so many calls before it answers.
class BusyService final : public v1::RenderService::Service {
 public:
  grpc::Status ListJobs(grpc::ServerContext* context, const v1::ListJobsRequest*,
                        v1::ListJobsResponse*) override {
    if (++calls > refusals) return grpc::Status::OK;
    if (!pushback.empty()) context->AddTrailingMetadata(proto::kRetryAfterKey, pushback);
    return {code, "there are too many calls from here"};
  }

  int refusals = 0;
  grpc::StatusCode code = grpc::StatusCode::RESOURCE_EXHAUSTED;
  std::string pushback = "1";
  std::atomic<int> calls{0};
};

class FarmCalls : public testing::Test {
 protected:
  FarmCalls() {
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    farm_ = std::move(*Farm::open({.address = "127.0.0.1:" + std::to_string(port), .security = {}}));
  }
  core::Result<v1::ListJobsResponse> list() {
    testing::internal::CaptureStderr();
    auto answer = farm_->call(&Farm::Stub::ListJobs, v1::ListJobsRequest());
    told_ = testing::internal::GetCapturedStderr();
    return answer;
  }
  void expect_failure_at_once(ErrorCode code) {
    const auto answer = list();
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, code);
    EXPECT_EQ(answer.error().message, "there are too many calls from here");
    EXPECT_EQ(service_.calls, 1);
    EXPECT_EQ(told_, "");
  }

  BusyService service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Farm> farm_;
  std::string told_;  // on stderr
};

TEST_F(FarmCalls, ThatAreAskedToWaitAreTriedAgain) {
  service_.refusals = 3;
  EXPECT_TRUE(list());
  EXPECT_EQ(service_.calls, 4);
  EXPECT_EQ(told_, "tessera: warning: there are too many calls from here; trying again\n");
  service_.calls = 0;
  EXPECT_TRUE(list());
  EXPECT_EQ(told_, "") << "it is told once";
}

TEST_F(FarmCalls, ThatAreOverALimitFailAtOnce) {
  service_.refusals = 3;
  service_.pushback = "";
  expect_failure_at_once(ErrorCode::kResourceExhausted);
}

TEST_F(FarmCalls, ThatAreNotToBeTriedAgainFailAtOnce) {
  service_.refusals = 3;
  service_.pushback = "-1";
  expect_failure_at_once(ErrorCode::kResourceExhausted);
}

TEST_F(FarmCalls, DoNotWaitForHours) {
  service_.refusals = 3;
  service_.pushback = "7200000";
  expect_failure_at_once(ErrorCode::kUnavailable);
}

TEST_F(FarmCalls, DoNotWaitForACoordinatorThatNeverAnswered) {
  service_.refusals = 3;
  service_.pushback = "";
  service_.code = grpc::StatusCode::UNAVAILABLE;
  expect_failure_at_once(ErrorCode::kUnavailable);
}

TEST_F(FarmCalls, OfLongerTasksAreTriedAgain) {
  service_.refusals = 2;
  service_.pushback = "";
  service_.code = grpc::StatusCode::UNAVAILABLE;
  testing::internal::CaptureStderr();
  const auto answer = patiently<v1::ListJobsResponse>(
      *farm_, [&] { return farm_->call(&Farm::Stub::ListJobs, v1::ListJobsRequest()); });
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("; trying again"));
  EXPECT_TRUE(answer);
  EXPECT_EQ(service_.calls, 3);
}

}  // namespace
}  // namespace tessera::client
