// Blobs on their way in and out, 1 MiB at a time.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <mutex>
#include <optional>

#include "server/coordinator/coordinator.hpp"
#include "server/coordinator/thread_pool.hpp"
#include "server/rpc/stream_limits.hpp"
#include "server/store/blob_store.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::rpc {

// Both are owned by gRPC until OnDone. There is never more than one operation under way, so that their
// members need no lock, but for those that say when and whether an upload is ended for standing still.

// One blob from a client into the store.
class UploadStream final : public grpc::ServerReadReactor<v1::UploadBlobRequest>, private WatchedStream {
 public:
  // `place` is one of streams.uploads.
  UploadStream(coordinator::Coordinator& coordinator, coordinator::ThreadPool& pool, StreamLimits& streams,
               coordinator::FairShare::Held place, v1::UploadBlobResponse* response);

 private:
  void OnReadDone(bool ok) override;
  void OnDone() override;
  void end_if_waiting_since(Clock::time_point time) override;

  void read_next();
  core::Status take_chunk();
  core::Status begin(const v1::Digest& message);
  // Whether the store has room for so many bytes more.
  core::Status make_room(std::uint64_t bytes);
  core::Status commit();

  coordinator::Coordinator& coordinator_;
  coordinator::ThreadPool& pool_;
  StreamLimits& streams_;
  const coordinator::FairShare::Held place_;
  v1::UploadBlobResponse* const response_;
  v1::UploadBlobRequest request_;
  std::optional<store::BlobWriter> writer_;  // from the first chunk on

  std::mutex mutex_;
  std::optional<Clock::time_point> waiting_since_;  // guarded by mutex_; while a read is under way
  bool ended_ = false;                              // guarded by mutex_; for standing still
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
