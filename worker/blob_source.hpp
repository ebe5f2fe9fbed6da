// SPDX-License-Identifier: Apache-2.0
// Where a worker gets blobs from.
#pragma once

#include <stop_token>

#include "core/base/error.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/partial_blob.hpp"

namespace tessera::worker {

class BlobSource {
 public:
  virtual ~BlobSource() = default;
  // Writes all of the blob, and verifies its digest. Blocks; returns soon after a stop. Errors are those of
  // FetchBlob, CANCELLED after a stop, DATA_LOSS if the bytes are not the blob's, INTERNAL if they cannot be
  // written.
  virtual core::Status fetch(PartialBlob& into, const std::stop_token& stop) = 0;
};

// Ends a FetchBlob call. UNAVAILABLE if the coordinator has ended it early, CANCELLED after a stop.
core::Status finish_download(grpc::ClientReaderInterface<v1::FetchBlobResponse>& stream,
                             grpc::ClientContext& context, const std::stop_token& stop);

// Whole blobs from the coordinator. Thread-safe.
class CoordinatorSource final : public BlobSource {
 public:
  // The stub must outlive it.
  explicit CoordinatorSource(v1::WorkerService::StubInterface& coordinator) : coordinator_(coordinator) {}
  core::Status fetch(PartialBlob& into, const std::stop_token& stop) override;

 private:
  v1::WorkerService::StubInterface& coordinator_;
};

}  // namespace tessera::worker
