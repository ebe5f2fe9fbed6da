// SPDX-License-Identifier: Apache-2.0
// The service in process, over real gRPC on a free port.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <future>

#include "core/image/encode.hpp"
#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "server/rpc/server.hpp"
#include "tessera/v1/render_service.grpc.pb.h"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::rpc {
namespace {

using server::delivery_with_key;
using server::greeting_with_key;
using server::submission;
using testing::HasSubstr;

class Service : public testing::Test {
 protected:
  Service() {
    auto state = store::StateDirectory::open(folder_.path());
    server::CoordinatorOptions options;
    options.farm.fingerprints = {server::kFingerprint};
    coordinator_ = std::move(*server::Coordinator::open(options, std::move(*state), server::accept_scene));
    server_ = std::move(*Server::start(*coordinator_, {.address = "127.0.0.1:0"}));
    const auto channel = *proto::open_channel(server_->address());
    users_ = v1::RenderService::NewStub(channel);
    workers_ = v1::WorkerService::NewStub(channel);
  }

  grpc::Status upload(const std::vector<v1::BlobChunk>& chunks) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto stream = users_->UploadBlob(&context, &response);
    v1::UploadBlobRequest request;
    for (const v1::BlobChunk& chunk : chunks) {
      *request.mutable_chunk() = chunk;
      if (!stream->Write(request)) break;
    }
    stream->WritesDone();
    return stream->Finish();
  }
  grpc::Status upload(const std::string& bytes) {
    std::vector<v1::BlobChunk> chunks;
    proto::for_each_chunk(proto::digest_of(bytes), bytes, [&](const v1::BlobChunk& chunk) {
      chunks.push_back(chunk);
      return true;
    });
    return upload(chunks);
  }

  std::string submit() {
    EXPECT_TRUE(upload(server::kSceneBytes).ok());
    grpc::ClientContext context;
    v1::SubmitJobResponse response;
    const grpc::Status status = users_->SubmitJob(&context, submission(), &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    while (job(response.job().id()).state() == v1::JOB_STATE_VALIDATING) std::this_thread::yield();
    return response.job().id();
  }

  v1::Job job(const std::string& id) {
    grpc::ClientContext context;
    v1::GetJobRequest request;
    request.set_job_id(id);
    v1::GetJobResponse response;
    EXPECT_TRUE(users_->GetJob(&context, request, &response).ok());
    return response.job();
  }

  void work_until_done(const std::string& id) {
    while (job(id).samples_done() < server::kSamples) {
      grpc::ClientContext context;
      v1::SynchronizeResponse response;
      ASSERT_TRUE(workers_->Synchronize(&context, greeting_with_key('a'), &response).ok());
      for (const v1::Lease& lease : response.leases()) {
        grpc::ClientContext delivering;
        v1::SubmitResultResponse counted;
        const grpc::Status status =
            workers_->SubmitResult(&delivering, delivery_with_key('a', lease), &counted);
        ASSERT_TRUE(status.ok()) << status.error_message();
      }
    }
    while (job(id).state() == v1::JOB_STATE_RUNNING)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }

  grpc::Status fetch(const proto::Digest& digest, std::string& bytes) {
    grpc::ClientContext context;
    v1::FetchBlobRequest request;
    *request.mutable_digest() = proto::to_proto(digest);
    const auto stream = workers_->FetchBlob(&context, request);
    v1::FetchBlobResponse response;
    while (stream->Read(&response)) {
      EXPECT_LE(response.chunk().data().size(), proto::kChunkBytes);
      EXPECT_EQ(response.chunk().has_digest(), bytes.empty());
      bytes += response.chunk().data();
    }
    return stream->Finish();
  }

  grpc::Status get_image(const std::string& id, v1::ImageFormat format, std::string& bytes,
                         const v1::DisplayOverrides& display = {}) {
    grpc::ClientContext context;
    v1::GetImageRequest request;
    *request.mutable_display() = display;
    request.set_job_id(id);
    request.set_format(format);
    const auto stream = users_->GetImage(&context, request);
    v1::GetImageResponse response;
    std::uint64_t promised = 0;
    while (stream->Read(&response)) {
      if (response.has_header()) promised = response.header().size_bytes();
      bytes += response.data();
    }
    EXPECT_EQ(bytes.size(), promised);
    return stream->Finish();
  }

  TemporaryFolder folder_;
  std::unique_ptr<server::Coordinator> coordinator_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<v1::RenderService::Stub> users_;
  std::unique_ptr<v1::WorkerService::Stub> workers_;
};

TEST_F(Service, FromSubmissionToTheImage) {
  const std::string id = submit();
  work_until_done(id);
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
  const core::Image expected = server::ready_made_image(server::kWidthPx, server::kHeightPx, server::kSpp);
  const std::pair<v1::ImageFormat, core::ImageFormat> formats[] = {
      {v1::IMAGE_FORMAT_PNG, core::ImageFormat::kPng},
      {v1::IMAGE_FORMAT_EXR, core::ImageFormat::kExr},
      {v1::IMAGE_FORMAT_HDR, core::ImageFormat::kHdr},
      {v1::IMAGE_FORMAT_PFM, core::ImageFormat::kPfm}};
  for (const auto& [wire, format] : formats) {
    std::string bytes;
    ASSERT_TRUE(get_image(id, wire, bytes).ok());
    EXPECT_TRUE(bytes == *core::encode_image(expected, format)) << core::image_format_name(format);
  }
}

TEST_F(Service, PngFilesAreShownAsTheJobOrTheCallSays) {
  const std::string id = submit();
  work_until_done(id);
  const core::Image image = server::ready_made_image(server::kWidthPx, server::kHeightPx, server::kSpp);
  v1::DisplayOverrides display;
  display.set_exposure_stops(-3);
  display.set_tone_curve(v1::TONE_CURVE_ACES);
  std::string png, exr;
  ASSERT_TRUE(get_image(id, v1::IMAGE_FORMAT_PNG, png, display).ok());
  EXPECT_TRUE(png == *core::encode_image(image, core::ImageFormat::kPng, {-3, core::ToneCurve::kAces}));
  ASSERT_TRUE(get_image(id, v1::IMAGE_FORMAT_EXR, exr, display).ok());
  EXPECT_TRUE(exr == *core::encode_image(image, core::ImageFormat::kExr));
  display.set_exposure_stops(99);
  EXPECT_EQ(get_image(id, v1::IMAGE_FORMAT_PNG, png = "", display).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(Service, TheImageOfARunningJobAndOfNone) {
  const std::string id = submit();
  std::string bytes;
  EXPECT_TRUE(get_image(id, v1::IMAGE_FORMAT_PNG, bytes).ok());
  EXPECT_EQ(get_image(id, v1::IMAGE_FORMAT_UNSPECIFIED, bytes = "").error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(get_image("nobody", v1::IMAGE_FORMAT_PNG, bytes = "").error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(Service, BlobsGoInAndOutInPieces) {
  std::string bytes(3 * proto::kChunkBytes + 17, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i >> 7);
  const proto::Digest digest = proto::digest_of(bytes);
  v1::FindMissingBlobsRequest question;
  *question.add_digests() = proto::to_proto(digest);
  *question.add_digests() = proto::to_proto(digest);
  {
    grpc::ClientContext context;
    v1::FindMissingBlobsResponse missing;
    ASSERT_TRUE(users_->FindMissingBlobs(&context, question, &missing).ok());
    EXPECT_EQ(missing.missing_size(), 1);
  }
  ASSERT_TRUE(upload(bytes).ok());
  {
    grpc::ClientContext context;
    v1::FindMissingBlobsResponse missing;
    ASSERT_TRUE(users_->FindMissingBlobs(&context, question, &missing).ok());
    EXPECT_EQ(missing.missing_size(), 0);
  }
  std::string fetched;
  ASSERT_TRUE(fetch(digest, fetched).ok());
  EXPECT_TRUE(fetched == bytes);
}

TEST_F(Service, TheEmptyBlobCanBeFetched) {
  ASSERT_TRUE(upload("").ok());
  std::string fetched;
  EXPECT_TRUE(fetch(proto::digest_of(""), fetched).ok());
  EXPECT_EQ(fetched, "");
}

TEST_F(Service, ABlobThatIsNotHereIsNotFound) {
  std::string fetched;
  EXPECT_EQ(fetch(proto::digest_of("x"), fetched).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(Service, UploadsThatBreakTheRulesAreRefused) {
  v1::BlobChunk forged, nameless, long_one, second;
  *forged.mutable_digest() = *long_one.mutable_digest() = *second.mutable_digest() =
      proto::to_proto(proto::digest_of("wanted"));
  forged.set_data("forged");
  nameless.set_data("wanted");
  long_one.set_data("wanted and more");
  EXPECT_EQ(upload({forged}).error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_EQ(upload({nameless}).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(upload({long_one}).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(upload({second, second}).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(upload(std::vector<v1::BlobChunk>{}).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(Service, WatchingShowsTheJobUntilItIsDone) {
  const std::string id = submit();
  grpc::ClientContext context;
  v1::WatchJobRequest request;
  request.set_job_id(id);
  const auto stream = users_->WatchJob(&context, request);
  v1::WatchJobResponse response;
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(response.job().state(), v1::JOB_STATE_RUNNING);
  work_until_done(id);
  while (stream->Read(&response)) {
  }
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(response.job().state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(response.job().samples_done(), server::kSamples);
}

TEST_F(Service, WatchingEndsWithADeletedJob) {
  const std::string id = submit();
  grpc::ClientContext context, deleting;
  v1::WatchJobRequest request;
  request.set_job_id(id);
  const auto stream = users_->WatchJob(&context, request);
  v1::WatchJobResponse response;
  ASSERT_TRUE(stream->Read(&response));
  v1::DeleteJobRequest gone;
  v1::DeleteJobResponse deleted;
  gone.set_job_id(id);
  ASSERT_TRUE(users_->DeleteJob(&deleting, gone, &deleted).ok());
  while (stream->Read(&response)) {
  }
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(Service, AWatcherThatLeavesIsForgotten) {
  const std::string id = submit();
  {
    grpc::ClientContext context;
    v1::WatchJobRequest request;
    request.set_job_id(id);
    const auto stream = users_->WatchJob(&context, request);
    v1::WatchJobResponse response;
    ASSERT_TRUE(stream->Read(&response));
    context.TryCancel();
    EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  work_until_done(id);
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
}

TEST_F(Service, AWaitingWorkerIsWokenByASubmission) {
  std::promise<v1::SynchronizeResponse> answered;
  grpc::ClientContext context;
  const v1::SynchronizeRequest request = greeting_with_key('a');
  v1::SynchronizeResponse response;
  workers_->async()->Synchronize(&context, &request, &response, [&](const grpc::Status& status) {
    EXPECT_TRUE(status.ok()) << status.error_message();
    answered.set_value(response);
  });
  submit();
  EXPECT_EQ(answered.get_future().get().leases_size(), 1);
}

TEST_F(Service, StoppingEndsWaitingCallsAndStoresEverything) {
  const std::string id = submit();
  work_until_done(id);
  std::promise<grpc::Status> answered;
  grpc::ClientContext context;
  const v1::SynchronizeRequest request = greeting_with_key('b');
  v1::SynchronizeResponse response;
  workers_->async()->Synchronize(&context, &request, &response,
                                 [&](const grpc::Status& status) { answered.set_value(status); });
  while (coordinator_->dispatcher().workers().size() < 2) std::this_thread::yield();
  EXPECT_TRUE(server_->stop());
  EXPECT_EQ(answered.get_future().get().error_code(), grpc::StatusCode::UNAVAILABLE);
  coordinator_.reset();
  auto state = store::StateDirectory::open(folder_.path());
  ASSERT_TRUE(state);
  EXPECT_EQ((*state->jobs.jobs())[0].state, v1::JOB_STATE_DONE);
}

TEST_F(Service, ErrorsArriveWithTheirSentence) {
  grpc::ClientContext context;
  v1::SubmitJobResponse response;
  const grpc::Status status = users_->SubmitJob(&context, submission(), &response);  // nothing uploaded
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("folder/scene.json"));
}

TEST_F(Service, ATakenPortIsRefused) {
  const auto second = Server::start(*coordinator_, {.address = server_->address()});
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("cannot listen on " + server_->address()));
}

}  // namespace
}  // namespace tessera::rpc
