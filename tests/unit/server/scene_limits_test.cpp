// SPDX-License-Identifier: Apache-2.0
// Limits of validation, and calls that do not wait for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <string>
#include <vector>

#include "proto/status.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using testing::HasSubstr;

using SceneLimits = LimitedService;

TEST_F(SceneLimits, OfScenesThatWaitToBeValidated) {
  hold_up_scenes();
  start({.validations = 1, .waiting_scenes = 1});
  Submission first, second, third;
  submit(first);
  barrier_.wait_for_someone();
  submit(second);
  submit(third);
  // One of the two waits; the other is rejected before anything is opened.
  auto of_second = second.status.get_future(), of_third = third.status.get_future();
  const auto is_answered = [](auto& future) {
    return future.wait_for(std::chrono::milliseconds(1)) == std::future_status::ready;
  };
  bool second_refused = false;
  while (!(second_refused = is_answered(of_second)) && !is_answered(of_third)) {
  }
  const grpc::Status refused = (second_refused ? of_second : of_third).get();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(
      refused.error_message(),
      HasSubstr("1 scenes from here wait to be validated already, and this farm takes at most 1 from all "
                "callers (tessera-coordinator --max-waiting-scenes)"));
  EXPECT_EQ(proto::error_from_grpc(refused, second_refused ? second.context : third.context).code,
            core::ErrorCode::kUnavailable)
      << "it passes by itself";
  barrier_.open();
  EXPECT_TRUE(first.status.get_future().get().ok());
  EXPECT_TRUE((second_refused ? of_third : of_second).get().ok());
}

// The first answer, while others wait.
grpc::Status first_answer(std::vector<std::future<grpc::Status>>& futures) {
  while (true) {
    for (auto& future : futures) {
      if (future.valid() && future.wait_for(std::chrono::milliseconds(1)) == std::future_status::ready)
        return future.get();
    }
  }
}

TEST_F(SceneLimits, NoSubmitterFillsTheQueueOfScenes) {
  hold_up_scenes();
  start_with_names({.validations = 1, .waiting_scenes = 4});
  const auto ada = as("ada"), ben = as("ben");
  std::vector<std::unique_ptr<Submission>> submissions;
  std::vector<std::future<grpc::Status>> of_ada, of_ben;
  const auto submit_as = [&](v1::RenderService::Stub& user, std::vector<std::future<grpc::Status>>& answers) {
    submissions.push_back(std::make_unique<Submission>());
    answers.push_back(submissions.back()->status.get_future());
    submit(user, *submissions.back());
  };
  submit_as(*ada, of_ada);
  barrier_.wait_for_someone();
  for (int i = 0; i < 3; ++i) submit_as(*ada, of_ada);
  const grpc::Status refused = first_answer(of_ada);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.error_message(),
            "2 scenes from here wait to be validated already, and this farm takes at most 4 from all callers "
            "(tessera-coordinator --max-waiting-scenes), some of which it keeps for others");
  for (int i = 0; i < 2; ++i) submit_as(*ben, of_ben);
  EXPECT_THAT(first_answer(of_ben).error_message(), HasSubstr("1 scenes from here wait"))
      << "one of his is let in";
  barrier_.open();
  for (auto* answers : {&of_ada, &of_ben}) {
    for (auto& answer : *answers) {
      if (answer.valid()) {
        EXPECT_TRUE(answer.get().ok());
      }
    }
  }
}

TEST_F(SceneLimits, PicturesAndExtensionsDoNotWaitForScenes) {
  start({});
  grpc::ClientContext submitting;
  v1::SubmitJobResponse submitted;
  ASSERT_TRUE(users_->SubmitJob(&submitting, submission(), &submitted).ok());
  const std::string id = submitted.job().id();
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

// Waiting scenes are answered without validation.
TEST_F(SceneLimits, StoppingDoesNotWorkOffTheScenesThatWait) {
  std::atomic<int> checked{0};
  check_scene_ = [&](const v1::Bundle&, const v1::RenderOverrides&) -> core::Result<jobs::CheckedScene> {
    ++checked;
    barrier_.wait();
    return core::fail(core::ErrorCode::kUnavailable, "stopped");  // like the validator process
  };
  start({.validations = 1});
  std::vector<std::unique_ptr<Submission>> submissions;
  for (int i = 0; i < 8; ++i) submit(*submissions.emplace_back(std::make_unique<Submission>()));
  barrier_.wait_for_someone();
  open_when_it_stops();
  EXPECT_TRUE(server_->stop());
  for (const auto& submission : submissions) EXPECT_FALSE(submission->status.get_future().get().ok());
  EXPECT_EQ(checked, 1);
}

}  // namespace
}  // namespace tessera::rpc
