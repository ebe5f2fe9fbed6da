// SPDX-License-Identifier: Apache-2.0
// Limits of validation, and calls that do not wait for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <stop_token>
#include <string>
#include <thread>

#include "proto/status.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using testing::HasSubstr;

class SceneLimits : public LimitedService {
 protected:
  struct Answer {
    grpc::Status status;
    core::Error error;
    v1::Job job;
  };
  Answer submit_as(v1::RenderService::Stub& user, const std::string& request_id = {}) {
    v1::SubmitJobRequest request = submission();
    request.set_request_id(request_id);
    grpc::ClientContext context;
    v1::SubmitJobResponse response;
    const grpc::Status status = user.SubmitJob(&context, request, &response);
    return {status, status.ok() ? core::Error{} : proto::error_from_grpc(status, context), response.job()};
  }
  v1::JobState state(const std::string& id) { return coordinator_->jobs().get(id)->state(); }
  void wait_for(v1::JobState expected, const std::string& id) {
    while (state(id) != expected) std::this_thread::yield();
  }
};

TEST_F(SceneLimits, OfScenesThatWaitToBeValidated) {
  hold_up_scenes();
  start({.validations = 1, .waiting_scenes = 1});
  const Answer first = submit_as(*users_);
  barrier_.wait_for_someone();
  const Answer second = submit_as(*users_, "second"), third = submit_as(*users_);
  ASSERT_TRUE(first.status.ok() && second.status.ok());
  EXPECT_EQ(first.job.state(), v1::JOB_STATE_VALIDATING);
  EXPECT_EQ(third.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(
      third.status.error_message(),
      HasSubstr("1 scenes from here wait to be validated already, and this farm takes at most 1 from all "
                "callers (tessera-coordinator --max-waiting-scenes)"));
  EXPECT_EQ(third.error.code, core::ErrorCode::kUnavailable) << "it passes by itself";
  EXPECT_EQ(core::details_of(third.error).reason, "TRY_LATER");
  EXPECT_EQ(core::details_of(third.error).retry_delay_ms, 1000u);
  EXPECT_EQ(submit_as(*users_, "second").job.id(), second.job.id()) << "it waits already";
  EXPECT_EQ(coordinator_->jobs().list()->jobs_size(), 2) << "what is refused is no job";
  barrier_.open();
  wait_for(v1::JOB_STATE_RUNNING, first.job.id());
  wait_for(v1::JOB_STATE_RUNNING, second.job.id());
}

TEST_F(SceneLimits, NoSubmitterFillsTheQueueOfScenes) {
  hold_up_scenes();
  start_with_names({.validations = 1, .waiting_scenes = 4});
  const auto ada = as("ada"), ben = as("ben");
  ASSERT_TRUE(submit_as(*ada).status.ok());
  barrier_.wait_for_someone();
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(submit_as(*ada).status.ok());
  EXPECT_EQ(submit_as(*ada).status.error_message(),
            "2 scenes from here wait to be validated already, and this farm takes at most 4 from all callers "
            "(tessera-coordinator --max-waiting-scenes), some of which it keeps for others");
  EXPECT_TRUE(submit_as(*ben).status.ok());
  EXPECT_THAT(submit_as(*ben).status.error_message(), HasSubstr("1 scenes from here wait"));
  barrier_.open();
}

TEST_F(SceneLimits, ARepeatedSubmissionStartsNoSecondValidation) {
  std::atomic<int> checked{0};
  check_scene_ = [&](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                     const std::vector<std::int32_t>&, const std::stop_token&) {
    ++checked;
    barrier_.wait();
    return server::accept_scene(bundle, overrides);
  };
  start({.validations = 2});
  const Answer first = submit_as(*users_, "once");
  barrier_.wait_for_someone();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(submit_as(*users_, "once").job.id(), first.job.id());
  barrier_.open();
  wait_for(v1::JOB_STATE_RUNNING, first.job.id());
  EXPECT_EQ(submit_as(*users_, "once").job.state(), v1::JOB_STATE_RUNNING);
  EXPECT_EQ(checked, 1);
}

// As if the process of the validator were killed.
jobs::SceneCheck check_until_stopped(std::atomic<int>& stopped) {
  return [&](const v1::Bundle&, const v1::RenderOverrides&, const std::vector<std::int32_t>&,
             const std::stop_token& stop) -> core::Result<jobs::CheckedScene> {
    std::promise<void> asked;
    const std::stop_callback at_stop(stop, [&] { asked.set_value(); });
    asked.get_future().wait();
    ++stopped;
    return core::fail(core::ErrorCode::kUnavailable, "stopped");
  };
}

TEST_F(SceneLimits, CancellingAndDeletingEndTheValidation) {
  std::atomic<int> stopped{0};
  check_scene_ = check_until_stopped(stopped);
  start({.validations = 1});
  const Answer first = submit_as(*users_), second = submit_as(*users_);
  EXPECT_EQ(coordinator_->jobs().pause(first.job.id()).error().code, core::ErrorCode::kFailedPrecondition);
  EXPECT_EQ(coordinator_->jobs().cancel(first.job.id())->state(), v1::JOB_STATE_CANCELLED);
  EXPECT_TRUE(coordinator_->jobs().remove(second.job.id()));
  EXPECT_EQ(coordinator_->jobs().cancel(first.job.id())->state(), v1::JOB_STATE_CANCELLED) << "again";
  EXPECT_EQ(coordinator_->jobs().list()->jobs_size(), 1);
  EXPECT_TRUE(server_->stop());
  server_.reset();
  EXPECT_LE(stopped, 2);
  coordinator_.reset();
  check_scene_ = server::accept_scene;
  start({});
  EXPECT_EQ(state(first.job.id()), v1::JOB_STATE_CANCELLED);
  EXPECT_EQ(coordinator_->jobs().list()->jobs_size(), 1);
}

TEST_F(SceneLimits, AScenesValidationIsRepeatedAfterARestart) {
  std::atomic<int> stopped{0};
  check_scene_ = check_until_stopped(stopped);
  start({.validations = 1});
  const std::string running = submit_as(*users_, "once").job.id(), waiting = submit_as(*users_).job.id();
  EXPECT_TRUE(server_->stop());
  server_.reset();
  coordinator_.reset();
  check_scene_ = server::accept_scene;
  start({.validations = 1, .waiting_scenes = 1});
  EXPECT_EQ(submit_as(*users_, "once").job.id(), running);
  wait_for(v1::JOB_STATE_RUNNING, running);
  wait_for(v1::JOB_STATE_RUNNING, waiting);
}

TEST_F(SceneLimits, ImagesAndExtensionsDoNotWaitForScenes) {
  start({});
  grpc::ClientContext submitting;
  v1::SubmitJobResponse submitted;
  ASSERT_TRUE(users_->SubmitJob(&submitting, submission(), &submitted).ok());
  const std::string id = wait_until_validated(submitted.job().id());
  server_.reset();
  coordinator_.reset();
  hold_up_scenes();
  start({.validations = 1});
  Submission slow;
  submit(slow);
  barrier_.wait_for_someone();
  grpc::ClientContext extending, imaging;
  v1::ExtendJobRequest extension;
  extension.set_job_id(id);
  extension.set_spp(server::kSpp + 2);
  v1::ExtendJobResponse extended;
  EXPECT_TRUE(users_->ExtendJob(&extending, extension, &extended).ok());
  v1::GetImageRequest request;
  request.set_job_id(id);
  request.set_format(v1::IMAGE_FORMAT_PNG);
  const auto stream = users_->GetImage(&imaging, request);
  v1::GetImageResponse response;
  while (stream->Read(&response)) {
  }
  EXPECT_TRUE(stream->Finish().ok());
  barrier_.open();
  EXPECT_TRUE(slow.status.get_future().get().ok());
}

TEST_F(SceneLimits, StoppingDoesNotWorkOffTheScenesThatWait) {
  std::atomic<int> checked{0};
  check_scene_ = [&](const v1::Bundle&, const v1::RenderOverrides&, const std::vector<std::int32_t>&,
                     const std::stop_token&) -> core::Result<jobs::CheckedScene> {
    ++checked;
    barrier_.wait();
    return core::fail(core::ErrorCode::kUnavailable, "stopped");  // like the validator process
  };
  start({.validations = 1});
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(submit_as(*users_).status.ok());
  barrier_.wait_for_someone();
  open_when_it_stops();
  EXPECT_TRUE(server_->stop());
  EXPECT_EQ(checked, 1);
  const auto listed = coordinator_->jobs().list();
  ASSERT_TRUE(listed);
  for (const v1::Job& job : listed->jobs()) EXPECT_EQ(job.state(), v1::JOB_STATE_VALIDATING);
}

}  // namespace
}  // namespace tessera::rpc
