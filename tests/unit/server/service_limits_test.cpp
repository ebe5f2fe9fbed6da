// The service's own limits, over real gRPC on a free port.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>

#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "proto/status.hpp"
#include "server/rpc/server.hpp"
#include "tessera/v1/render_service.grpc.pb.h"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::rpc {
namespace {

using coordinator::greeting;
using coordinator::submission;
using testing::HasSubstr;

// Holds up those who come until it is opened.
class Barrier {
 public:
  void wait() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void wait_for_someone() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_ > 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int waiting_ = 0;
  bool open_ = false;
};

class ServiceLimits : public testing::Test {
 protected:
  ~ServiceLimits() override { barrier_.open(); }

  void start(const server::Limits& limits) {
    auto state = store::StateDirectory::open(folder_.path());
    coordinator::Options options;
    options.limits = limits;
    coordinator_ = std::move(*coordinator::Coordinator::open(options, std::move(*state), check_scene_));
    server_ = std::move(*Server::start(*coordinator_, {.address = "127.0.0.1:0", .limits = limits}));
    users_ = v1::RenderService::NewStub(*proto::open_channel(server_->address()));
    workers_ = v1::WorkerService::NewStub(*proto::open_channel(server_->address()));
    auto writer = coordinator_->blobs().write(proto::digest_of(coordinator::kSceneBytes));
    ASSERT_TRUE(writer && writer->append(coordinator::kSceneBytes) && writer->commit());
  }
  void hold_up_scenes() {
    check_scene_ = [this](const v1::Bundle& bundle, const v1::RenderOverrides& overrides) {
      barrier_.wait();
      return coordinator::accept_scene(bundle, overrides);
    };
  }

  // A stream whose first message says so many bytes, and which brings these.
  grpc::Status upload(std::uint64_t said, const std::string& bytes, int times = 1) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto stream = users_->UploadBlob(&context, &response);
    v1::UploadBlobRequest request;
    *request.mutable_chunk()->mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    request.mutable_chunk()->mutable_digest()->set_size_bytes(said);
    request.mutable_chunk()->set_data(bytes);
    for (int i = 0; i < times && stream->Write(request); ++i) request.mutable_chunk()->clear_digest();
    stream->WritesDone();
    return stream->Finish();
  }
  std::size_t files_in(const std::string& folder) {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.path() / "blobs" / folder), {}));
  }
  grpc::Status list(grpc::ClientContext& context) {
    v1::ListJobsResponse response;
    return users_->ListJobs(&context, {}, &response);
  }
  struct Submission {
    Submission() { context.set_wait_for_ready(true); }
    grpc::ClientContext context;
    v1::SubmitJobRequest request = submission();
    v1::SubmitJobResponse response;
    std::promise<grpc::Status> status;
  };
  void submit(Submission& submission) {
    users_->async()->SubmitJob(
        &submission.context, &submission.request, &submission.response,
        [&submission](const grpc::Status& status) { submission.status.set_value(status); });
  }

  // A coordinator that stops answers those who wait.
  void open_when_it_stops() {
    coordinator_->synchronize(greeting('a'), {.answer = [this](const auto& answer) {
                                if (!answer) return barrier_.open();
                                open_when_it_stops();
                              }});
  }

  TemporaryFolder folder_;
  coordinator::SceneCheck check_scene_ = coordinator::accept_scene;
  Barrier barrier_;
  std::unique_ptr<coordinator::Coordinator> coordinator_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<v1::RenderService::Stub> users_;
  std::unique_ptr<v1::WorkerService::Stub> workers_;
};

TEST_F(ServiceLimits, OfBlobsIsTheSizeThatTheyAreSaidToHave) {
  start({.blob_mib = 1});
  const grpc::Status status = upload((1 << 20) + 1, "the first of a million bytes");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(),
              HasSubstr("the file has 1048577 bytes, and this farm takes at most 1 MiB "
                        "(tessera-coordinator --max-blob-mib)"));
  EXPECT_EQ(files_in("incoming"), 0u);
  const std::string largest(1 << 20, 'x');
  EXPECT_TRUE(upload(largest.size(), largest).ok());
}

TEST_F(ServiceLimits, AStreamThatBringsMoreThanItSaidEndsThere) {
  start({.blob_mib = 1});
  const std::string chunk(1 << 20, 'x');
  const grpc::Status more = upload(chunk.size(), chunk, 50);
  EXPECT_EQ(more.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(more.error_message(), HasSubstr("more bytes than the 1048576 its digest says"));
  EXPECT_EQ(upload(chunk.size(), "less").error_code(), grpc::StatusCode::DATA_LOSS);
  server_.reset();  // a stream may end a little later than its caller hears of it
  EXPECT_EQ(files_in("incoming"), 0u);
}

TEST_F(ServiceLimits, OfMessages) {
  start({.message_mib = 1});
  grpc::ClientContext context;
  v1::GetJobRequest request;
  request.set_job_id(std::string(2 << 20, 'x'));
  v1::GetJobResponse response;
  EXPECT_EQ(users_->GetJob(&context, request, &response).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  grpc::ClientContext after;
  EXPECT_TRUE(list(after).ok());
}

TEST_F(ServiceLimits, OfCallsSayWhenToTryAgain) {
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
    v1::SynchronizeRequest request = greeting('a');
    request.set_wanted_leases(0);
    request.set_draining(true);
    EXPECT_TRUE(workers_->Synchronize(&working, request, &response).ok()) << "workers count by themselves";
    return;
  }
  FAIL() << "nothing was refused";
}

TEST_F(ServiceLimits, OfWorkersCallsAsWell) {
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

TEST_F(ServiceLimits, OfScenesThatWaitToBeValidated) {
  hold_up_scenes();
  start({.validations = 1, .waiting_scenes = 1});
  Submission first, second, third;
  submit(first);
  barrier_.wait_for_someone();
  submit(second);
  submit(third);
  // One of the two waits; the other is refused before anything is opened.
  auto of_second = second.status.get_future(), of_third = third.status.get_future();
  const auto is_answered = [](auto& future) {
    return future.wait_for(std::chrono::milliseconds(1)) == std::future_status::ready;
  };
  bool second_refused = false;
  while (!(second_refused = is_answered(of_second)) && !is_answered(of_third)) {
  }
  const grpc::Status refused = (second_refused ? of_second : of_third).get();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(refused.error_message(),
              HasSubstr("too many scenes wait to be validated, and this farm takes at most 1 "
                        "(tessera-coordinator --max-waiting-scenes)"));
  EXPECT_EQ(proto::error_from_grpc(refused, second_refused ? second.context : third.context).code,
            core::ErrorCode::kUnavailable)
      << "it passes by itself";
  barrier_.open();
  EXPECT_TRUE(first.status.get_future().get().ok());
  EXPECT_TRUE((second_refused ? of_third : of_second).get().ok());
}

TEST_F(ServiceLimits, PicturesAndExtensionsDoNotWaitForScenes) {
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
  extension.set_spp(coordinator::kSpp + 2);
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

// Those that wait are answered without being looked at.
TEST_F(ServiceLimits, StoppingDoesNotWorkOffTheScenesThatWait) {
  std::atomic<int> checked{0};
  check_scene_ = [&](const v1::Bundle&,
                     const v1::RenderOverrides&) -> core::Result<coordinator::CheckedScene> {
    ++checked;
    barrier_.wait();
    return core::fail(core::ErrorCode::kUnavailable, "stopped");  // as the validator's process answers
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
