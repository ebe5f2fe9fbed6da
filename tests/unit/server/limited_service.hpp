// SPDX-License-Identifier: Apache-2.0
// A coordinator with limits, over real gRPC on a free port, and callers that reach the limits.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "server/rpc/server.hpp"
#include "tessera/v1/render_service.grpc.pb.h"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::rpc {

using server::greeting;
using server::greeting_with_key;
using server::submission;

// Blocks callers until it is opened.
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

class LimitedService : public testing::Test {
 protected:
  ~LimitedService() override { barrier_.open(); }

  // With tokens for ada and ben.
  void start_with_names(const server::Limits& limits) {
    for (const std::string name : {"ada", "ben"}) {
      write_file(folder_.path() / name, std::string(16, name[0]));
      write_file(folder_.path() / "tokens", read_file(folder_.path() / "tokens") + "submit " + name + " " +
                                                std::string(16, name[0]) + "\n");
    }
    access_ = *auth::Access::read(folder_.path() / "tokens");
    start(limits);
  }
  std::unique_ptr<v1::RenderService::Stub> as(const std::string& name) {
    proto::ClientSecurity security;
    security.token = folder_.path() / name;
    return v1::RenderService::NewStub(*proto::open_channel(server_->address(), security));
  }
  void start(const server::Limits& limits) {
    auto state = store::StateDirectory::open(folder_.path());
    server::CoordinatorOptions options;
    options.limits = limits;
    options.farm.now = [this] { return std::chrono::steady_clock::now() + passed_.load(); };
    options.farm.fingerprints = {server::kFingerprint};
    options.farm.lease_duration = lease_duration_;
    coordinator_ = std::move(*server::Coordinator::open(options, std::move(*state), check_scene_));
    server_ = std::move(
        *Server::start(*coordinator_, {.address = "127.0.0.1:0", .access = access_, .limits = limits}));
    users_ = v1::RenderService::NewStub(*proto::open_channel(server_->address()));
    workers_ = v1::WorkerService::NewStub(*proto::open_channel(server_->address()));
    auto writer = coordinator_->blobs().write(proto::digest_of(server::kSceneBytes));
    ASSERT_TRUE(writer && writer->append(server::kSceneBytes) && writer->commit());
  }
  // Advances the clock at once.
  void pass(std::chrono::minutes time) { passed_ = passed_.load() + time; }
  void hold_up_scenes() {
    check_scene_ = [this](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                          const std::vector<std::int32_t>&, const std::stop_token&) {
      barrier_.wait();
      return server::accept_scene(bundle, overrides);
    };
  }

  // An upload that declares `said` bytes and sends these.
  grpc::Status upload(std::uint64_t said, const std::string& bytes, int times = 1) {
    return upload(*users_, said, bytes, times);
  }
  grpc::Status upload(v1::RenderService::Stub& user, std::uint64_t said, const std::string& bytes,
                      int times = 1) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto stream = user.UploadBlob(&context, &response);
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
  // An upload in progress, which may stall.
  struct Upload {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    std::unique_ptr<grpc::ClientWriterInterface<v1::UploadBlobRequest>> stream;
  };
  // Sends the first byte, and waits until the coordinator has received it.
  std::unique_ptr<Upload> begin_upload(const std::string& bytes) {
    auto upload = std::make_unique<Upload>();
    upload->stream = users_->UploadBlob(&upload->context, &upload->response);
    v1::UploadBlobRequest request;
    *request.mutable_chunk()->mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    request.mutable_chunk()->set_data(bytes.substr(0, 1));
    const std::uint64_t before = coordinator_->files().used_bytes();
    EXPECT_TRUE(upload->stream->Write(request));
    const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (coordinator_->files().used_bytes() == before && std::chrono::steady_clock::now() < late)
      std::this_thread::yield();
    return upload;
  }
  grpc::Status finish_upload(Upload& upload, const std::string& bytes) {
    v1::UploadBlobRequest request;
    request.mutable_chunk()->set_data(bytes.substr(1));
    upload.stream->Write(request);
    upload.stream->WritesDone();
    return upload.stream->Finish();
  }
  // Retries until it is admitted: an ended stream gives its quota back slightly after its caller sees the
  // end.
  void expect_upload_in_the_end(const std::string& bytes) {
    grpc::Status status;
    do {
      status = upload(bytes.size(), bytes);
    } while (status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }
  struct Fetch {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReaderInterface<v1::GetImageResponse>> stream;
  };
  std::unique_ptr<Fetch> begin_fetch(const std::string& job) { return begin_fetch(*users_, job); }
  std::unique_ptr<Fetch> begin_fetch(v1::RenderService::Stub& user, const std::string& job) {
    auto fetch = std::make_unique<Fetch>();
    v1::GetImageRequest request;
    request.set_job_id(job);
    request.set_format(v1::IMAGE_FORMAT_PFM);
    fetch->stream = user.GetImage(&fetch->context, request);
    return fetch;
  }
  grpc::Status finish_fetch(Fetch& fetch) {
    v1::GetImageResponse response;
    while (fetch.stream->Read(&response)) {
    }
    return fetch.stream->Finish();
  }
  std::string wait_until_validated(const std::string& id) {
    while (coordinator_->jobs().get(id)->state() == v1::JOB_STATE_VALIDATING) std::this_thread::yield();
    return id;
  }
  std::string submit_now(const v1::SubmitJobRequest& request = submission()) {
    grpc::ClientContext context;
    v1::SubmitJobResponse response;
    EXPECT_TRUE(users_->SubmitJob(&context, request, &response).ok());
    return wait_until_validated(response.job().id());
  }
  // An image of 24 MB, more than all buffers hold while nobody reads. Encoding it takes 4 MiB.
  std::string submit_large() { return submit_of_size(2000, 1000); }
  std::string submit_of_size(std::uint32_t width_px, std::uint32_t height_px) {
    v1::SubmitJobRequest request = submission();
    request.mutable_overrides()->set_width_px(width_px);
    request.mutable_overrides()->set_height_px(height_px);
    return submit_now(request);
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
  void submit(Submission& submission) { submit(*users_, submission); }
  void submit(v1::RenderService::Stub& user, Submission& submission) {
    user.async()->SubmitJob(
        &submission.context, &submission.request, &submission.response,
        [&submission](const grpc::Status& status) { submission.status.set_value(status); });
  }

  // A stopping coordinator answers waiting calls.
  void open_when_it_stops() {
    coordinator_->dispatcher().synchronize(greeting('a'), {.answer = [this](const auto& answer) {
                                             if (!answer) return barrier_.open();
                                             open_when_it_stops();
                                           }});
  }

  TemporaryFolder folder_;
  std::atomic<std::chrono::minutes> passed_{std::chrono::minutes(0)};
  scheduler::Duration lease_duration_ = farm::Options().lease_duration;
  auth::Access access_;
  jobs::SceneCheck check_scene_ = server::accept_scene;
  Barrier barrier_;
  std::unique_ptr<server::Coordinator> coordinator_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<v1::RenderService::Stub> users_;
  std::unique_ptr<v1::WorkerService::Stub> workers_;
};

}  // namespace tessera::rpc
