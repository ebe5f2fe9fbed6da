// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/raw_worker.hpp"

#include <grpcpp/client_context.h>
#include <gtest/gtest.h>

#include <chrono>

#include "core/base/determinism_fingerprint.hpp"
#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "proto/worker_key.hpp"

namespace tessera::test {

RawWorker::RawWorker(const std::string& address, const std::string& name)
    : coordinator_(v1::WorkerService::NewStub(*proto::open_channel(address))) {
  request_.set_worker_key(proto::digest_of(name).hex().substr(0, proto::kWorkerKeyBytes));
  request_.set_worker_id(proto::worker_id_of(request_.worker_key()));
  request_.set_name(name);
  request_.set_determinism_fingerprint(std::string(core::kDeterminismFingerprint));
  request_.set_threads(1);
  request_.set_wanted_leases(1);
}

void RawWorker::say_fetching(const std::string& job_id) {
  request_.clear_fetching_job_ids();
  if (!job_id.empty()) request_.add_fetching_job_ids(job_id);
}

v1::SynchronizeResponse RawWorker::synchronize() {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
  v1::SynchronizeResponse response;
  const grpc::Status status = coordinator_->Synchronize(&context, request_, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  *request_.mutable_held() = response.leases();
  return response;
}

}  // namespace tessera::test
