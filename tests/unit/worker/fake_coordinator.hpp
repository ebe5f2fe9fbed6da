// SPDX-License-Identifier: Apache-2.0
// A scripted coordinator that records its requests, called in process. Thread-safe.
#pragma once

#include <grpcpp/server.h>

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tessera/v1/worker_service.grpc.pb.h"

namespace tessera::worker {

class FakeCoordinator final : public v1::WorkerService::Service {
 public:
  FakeCoordinator();
  ~FakeCoordinator() override;

  v1::WorkerService::StubInterface& stub() { return *stub_; }

  // The answer to Synchronize; by default it waits until the call is cancelled.
  using Answer = std::function<grpc::Status(const v1::SynchronizeRequest&, v1::SynchronizeResponse&)>;
  void answer_with(std::vector<Answer> answers);
  // The answers to SubmitResult in order; OK after the last.
  void refuse_results_with(std::vector<grpc::Status> statuses);
  void keep_blob(const std::string& sha256, const std::string& bytes);

  // Answers FetchBlob instead of the blobs that it keeps.
  using Download =
      std::function<grpc::Status(const v1::FetchBlobRequest&, grpc::ServerWriter<v1::FetchBlobResponse>&)>;
  void answer_downloads_with(Download download);

  // Block until there were so many calls.
  std::vector<v1::SynchronizeRequest> wait_for_syncs(std::size_t count);
  std::vector<v1::SubmitResultRequest> wait_for_results(std::size_t count);
  std::size_t fetches();

  grpc::Status Synchronize(grpc::ServerContext* context, const v1::SynchronizeRequest* request,
                           v1::SynchronizeResponse* response) override;
  grpc::Status SubmitResult(grpc::ServerContext* context, const v1::SubmitResultRequest* request,
                            v1::SubmitResultResponse* response) override;
  grpc::Status FetchBlob(grpc::ServerContext* context, const v1::FetchBlobRequest* request,
                         grpc::ServerWriter<v1::FetchBlobResponse>* writer) override;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Answer> answers_;
  std::vector<grpc::Status> result_statuses_;
  std::map<std::string, std::string> blobs_;
  std::vector<v1::SynchronizeRequest> syncs_;
  std::vector<v1::SubmitResultRequest> results_;
  std::size_t fetches_ = 0;
  Download download_;

  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::WorkerService::StubInterface> stub_;
};

}  // namespace tessera::worker
