// SPDX-License-Identifier: Apache-2.0
// Blobs on their way in and out, 1 MiB at a time.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <mutex>
#include <optional>
#include <string>

#include "server/coordinator/coordinator.hpp"
#include "server/rpc/pools.hpp"
#include "server/rpc/stream_limits.hpp"
#include "server/store/blob_store.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::rpc {

// Both are owned by gRPC until OnDone. There is never more than one operation under way, so that their
// members need no lock, but for those that say when and whether a call is ended for standing still.

struct UploadCall {
  std::string caller;                  // its key
  coordinator::FairShare::Held place;  // one of streams.uploads
  v1::UploadBlobResponse* response;
};

// One blob from a client into the store.
class UploadStream final : public grpc::ServerReadReactor<v1::UploadBlobRequest>, private WatchedStream {
 public:
  UploadStream(grpc::CallbackServerContext& context, coordinator::Coordinator& coordinator,
               const Pools& pools, StreamLimits& streams, UploadCall call);

 private:
  void OnReadDone(bool ok) override;
  void OnDone() override;
  void end_if_waiting_since(Clock::time_point time) override;

  void read_next();
  void take_chunk();
  core::Status check_chunk() const;
  void begin();
  // Goes on to make room, where that takes as long as it may, if there is none.
  void take_room(const proto::Digest& digest);
  void make_room(const proto::Digest& digest);
  void append();
  core::Status commit();

  grpc::CallbackServerContext& context_;
  coordinator::Coordinator& coordinator_;
  const Pools pools_;
  StreamLimits& streams_;
  const UploadCall call_;
  v1::UploadBlobRequest request_;
  // From the first chunk on:
  std::optional<coordinator::BlobClaims::Use> use_;
  std::optional<store::BlobWriter> writer_;

  std::mutex mutex_;
  std::optional<Clock::time_point> waiting_since_;  // guarded by mutex_; while a read is under way
  bool ended_ = false;                              // guarded by mutex_; for standing still
};

struct FetchCall {
  v1::Digest digest;
  coordinator::FairShare::Held place;  // one of streams.fetches
};

// One blob from the store to a worker.
class FetchStream final : public grpc::ServerWriteReactor<v1::FetchBlobResponse>, private WatchedStream {
 public:
  FetchStream(grpc::CallbackServerContext& context, coordinator::Coordinator& coordinator,
              coordinator::ThreadPool& pool, StreamLimits& streams, FetchCall call);

 private:
  void OnWriteDone(bool ok) override;
  void OnDone() override;
  void end_if_waiting_since(Clock::time_point time) override;

  core::Status open();
  void write_next();
  // Ends the call, and tells the coordinator what its store has lost.
  void fail(const core::Error& error);

  grpc::CallbackServerContext& context_;
  coordinator::Coordinator& coordinator_;
  coordinator::ThreadPool& pool_;
  StreamLimits& streams_;
  const FetchCall call_;
  v1::FetchBlobResponse response_;
  std::optional<store::BlobReader> reader_;
  std::uint64_t left_bytes_ = 0;

  std::mutex mutex_;
  std::optional<Clock::time_point> waiting_since_;  // guarded by mutex_; while a write is under way
};

}  // namespace tessera::rpc
