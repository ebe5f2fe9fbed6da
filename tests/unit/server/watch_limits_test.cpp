// SPDX-License-Identifier: Apache-2.0
// Limits of WatchJob calls.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "proto/status.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

class WatchLimits : public LimitedService {
 protected:
  struct Watch {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReaderInterface<v1::WatchJobResponse>> stream;
    v1::WatchJobResponse response;
  };
  static std::unique_ptr<Watch> begin_watch(v1::RenderService::Stub& user, const std::string& job) {
    auto watch = std::make_unique<Watch>();
    v1::WatchJobRequest request;
    request.set_job_id(job);
    watch->stream = user.WatchJob(&watch->context, request);
    return watch;
  }
  // Whether the call is admitted: then it receives the job.
  static bool is_let_in(Watch& watch) { return watch.stream->Read(&watch.response); }
  // An ended stream gives its quota back slightly after its caller sees the end.
  void expect_to_be_let_in_in_the_end(const std::string& job) {
    for (;;) {
      const auto watch = begin_watch(*users_, job);
      if (is_let_in(*watch)) break;
      ASSERT_EQ(watch->stream->Finish().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  // A client with a flow-control window of so many bytes.
  std::unique_ptr<v1::RenderService::Stub> user_with_window(int bytes) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, bytes);
    arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
    return v1::RenderService::NewStub(
        grpc::CreateCustomChannel(server_->address(), grpc::InsecureChannelCredentials(), arguments));
  }
};

TEST_F(WatchLimits, OfJobsThatAreWatchedAtOnce) {
  start({.watches = 2});
  const std::string job = submit_now();
  const auto first = begin_watch(*users_, job);
  ASSERT_TRUE(is_let_in(*first));
  const auto refused = begin_watch(*users_, job);
  EXPECT_FALSE(is_let_in(*refused));
  const grpc::Status status = refused->stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(status.error_message(),
            "1 jobs from here are being watched already, and this farm takes at most 2 from all callers "
            "(tessera-coordinator --max-watches), some of which it keeps for others");
  EXPECT_EQ(proto::error_from_grpc(status, refused->context).code, core::ErrorCode::kUnavailable)
      << "it passes by itself";
  first->context.TryCancel();
  expect_to_be_let_in_in_the_end(job);
}

TEST_F(WatchLimits, KeepPlacesForOthers) {
  start_with_names({.watches = 3});
  const auto ada = as("ada"), ben = as("ben");
  grpc::ClientContext context;
  v1::SubmitJobResponse response;
  ASSERT_TRUE(ada->SubmitJob(&context, submission(), &response).ok());
  const auto first = begin_watch(*ada, response.job().id()), second = begin_watch(*ada, response.job().id());
  EXPECT_TRUE(is_let_in(*first));
  EXPECT_TRUE(is_let_in(*second));
  const auto third = begin_watch(*ada, response.job().id()), others = begin_watch(*ben, response.job().id());
  EXPECT_FALSE(is_let_in(*third));
  EXPECT_TRUE(is_let_in(*others));
  for (const auto& watch : {first.get(), second.get(), others.get()}) watch->context.TryCancel();
}

TEST_F(WatchLimits, AStalledWatchIsEnded) {
  start({.watches = 2, .stall_time = std::chrono::seconds(3)});
  const std::string job = submit_now();
  const auto idle = user_with_window(16);
  const auto slow = begin_watch(*idle, job);
  slow->stream->WaitForInitialMetadata();
  expect_to_be_let_in_in_the_end(job);
  while (is_let_in(*slow)) {
  }
  EXPECT_EQ(slow->stream->Finish().error_code(), grpc::StatusCode::CANCELLED);
}

// Nothing is being sent to them, for any time.
TEST_F(WatchLimits, AWatcherOfAJobThatDoesNotChangeIsNotEnded) {
  start({.stall_time = std::chrono::milliseconds(200)});
  const std::string job = submit_now();
  const auto patient = begin_watch(*users_, job);
  ASSERT_TRUE(is_let_in(*patient));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  grpc::ClientContext context;
  v1::CancelJobRequest cancel;
  cancel.set_job_id(job);
  v1::CancelJobResponse cancelled;
  ASSERT_TRUE(users_->CancelJob(&context, cancel, &cancelled).ok());
  while (is_let_in(*patient)) {
  }
  EXPECT_TRUE(patient->stream->Finish().ok());
}

}  // namespace
}  // namespace tessera::rpc
