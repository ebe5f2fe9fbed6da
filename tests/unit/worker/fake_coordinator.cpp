// SPDX-License-Identifier: Apache-2.0
#include "fake_coordinator.hpp"

#include <grpcpp/server_builder.h>

#include <chrono>

#include "proto/blob.hpp"

namespace tessera::worker {

FakeCoordinator::FakeCoordinator() {
  grpc::ServerBuilder builder;
  builder.RegisterService(this);
  server_ = builder.BuildAndStart();
  stub_ = v1::WorkerService::NewStub(server_->InProcessChannel({}));
}

FakeCoordinator::~FakeCoordinator() {
  server_->Shutdown(std::chrono::system_clock::now());
}

void FakeCoordinator::answer_with(std::vector<Answer> answers) {
  std::lock_guard lock(mutex_);
  answers_ = std::move(answers);
}

void FakeCoordinator::refuse_results_with(std::vector<grpc::Status> statuses) {
  std::lock_guard lock(mutex_);
  result_statuses_ = std::move(statuses);
}

void FakeCoordinator::keep_blob(const std::string& sha256, const std::string& bytes) {
  std::lock_guard lock(mutex_);
  blobs_[sha256] = bytes;
}

void FakeCoordinator::answer_downloads_with(Download download) {
  std::lock_guard lock(mutex_);
  download_ = std::move(download);
}

std::vector<v1::SynchronizeRequest> FakeCoordinator::wait_for_syncs(std::size_t count) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return syncs_.size() >= count; });
  return syncs_;
}

std::vector<v1::SubmitResultRequest> FakeCoordinator::wait_for_results(std::size_t count) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return results_.size() >= count; });
  return results_;
}

std::size_t FakeCoordinator::fetches() {
  std::lock_guard lock(mutex_);
  return fetches_;
}

grpc::Status FakeCoordinator::Synchronize(grpc::ServerContext* context, const v1::SynchronizeRequest* request,
                                          v1::SynchronizeResponse* response) {
  Answer answer;
  {
    std::unique_lock lock(mutex_);
    const std::size_t call = syncs_.size();
    syncs_.push_back(*request);
    changed_.notify_all();
    if (call < answers_.size()) answer = answers_[call];
    while (!answer && !context->IsCancelled()) changed_.wait_for(lock, std::chrono::milliseconds(5));
  }
  return answer ? answer(*request, *response) : grpc::Status::CANCELLED;
}

grpc::Status FakeCoordinator::SubmitResult(grpc::ServerContext*, const v1::SubmitResultRequest* request,
                                           v1::SubmitResultResponse* response) {
  std::lock_guard lock(mutex_);
  const std::size_t call = results_.size();
  results_.push_back(*request);
  changed_.notify_all();
  response->set_accepted_items(static_cast<std::uint32_t>(request->items_size()));
  return call < result_statuses_.size() ? result_statuses_[call] : grpc::Status::OK;
}

grpc::Status FakeCoordinator::FetchBlob(grpc::ServerContext*, const v1::FetchBlobRequest* request,
                                        grpc::ServerWriter<v1::FetchBlobResponse>* writer) {
  std::lock_guard lock(mutex_);
  ++fetches_;
  if (download_) return download_(*request, *writer);
  const auto blob = blobs_.find(request->digest().sha256());
  if (blob == blobs_.end()) return {grpc::StatusCode::NOT_FOUND, "no such blob"};
  proto::for_each_chunk(proto::from_proto(request->digest()).value(), blob->second,
                        [&](const v1::BlobChunk& chunk) {
                          v1::FetchBlobResponse response;
                          *response.mutable_chunk() = chunk;
                          return writer->Write(response);
                        });
  return grpc::Status::OK;
}

}  // namespace tessera::worker
