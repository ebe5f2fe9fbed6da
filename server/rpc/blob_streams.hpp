// Blobs on their way in and out, 1 MiB at a time.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <optional>

#include "server/coordinator/coordinator.hpp"
#include "server/coordinator/thread_pool.hpp"
#include "server/limits.hpp"
#include "server/store/blob_store.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::rpc {

// Both are owned by gRPC until OnDone. There is never more than one operation under way, so that their
// members need no lock.

// One blob from a client into the store.
class UploadStream final : public grpc::ServerReadReactor<v1::UploadBlobRequest> {
 public:
  UploadStream(const store::BlobStore& blobs, coordinator::ThreadPool& pool, const server::Limits& limits,
               v1::UploadBlobResponse* response);

 private:
  void OnReadDone(bool ok) override;
  void OnDone() override { delete this; }

  core::Status take_chunk();
  core::Status commit();

  const store::BlobStore& blobs_;
  coordinator::ThreadPool& pool_;
  const server::Limits& limits_;
  v1::UploadBlobResponse* const response_;
  v1::UploadBlobRequest request_;
  std::optional<store::BlobWriter> writer_;  // from the first chunk on
};

// One blob from the store to a worker.
class FetchStream final : public grpc::ServerWriteReactor<v1::FetchBlobResponse> {
 public:
  FetchStream(coordinator::Coordinator& coordinator, coordinator::ThreadPool& pool, const v1::Digest& digest);

 private:
  void OnWriteDone(bool ok) override;
  void OnDone() override { delete this; }

  core::Status open(const v1::Digest& digest);
  void write_next();
  // Ends the call, and tells the coordinator what its store has lost.
  void fail(const core::Error& error);

  coordinator::Coordinator& coordinator_;
  coordinator::ThreadPool& pool_;
  const v1::Digest message_;
  v1::FetchBlobResponse response_;
  std::optional<store::BlobReader> reader_;
  std::uint64_t left_bytes_ = 0;
};

}  // namespace tessera::rpc
