// SPDX-License-Identifier: Apache-2.0
// Uploads and downloads of blobs in chunks of 1 MiB.
#pragma once

#include <optional>
#include <string>

#include "core/base/mutex.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/call.hpp"
#include "server/rpc/pools.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::rpc {

// Both classes are owned by gRPC until OnDone. At most one operation is in progress, so their members need no
// lock, except for those that record since when the stream waits and whether it was ended.
//
// One blob from a client into the store.
class UploadStream final : public Reactor, private WatchedStream {
 public:
  UploadStream(grpc::CallbackServerContext& context, server::Coordinator& coordinator, const Pools& pools,
               StreamLimits& streams, auth::Admission admission);

 private:
  void OnReadDone(bool ok) override;
  void OnDone() override;
  void end_if_waiting_since(Clock::time_point time) override;

  void read_next();
  void take_chunk();
  core::Status check_chunk() const;
  void begin();
  // Takes room in the store. If there is none, continues with make_room() on a thread that may block.
  void take_room(const proto::Digest& digest);
  void make_room(const proto::Digest& digest);
  void append();
  // Commits the blob and ends the call with the result. An incomplete blob is kept for a while.
  void commit();
  core::Status store();
  void keep_partial();
  const std::string& caller() const { return admission_.caller.key; }

  grpc::CallbackServerContext& context_;
  server::Coordinator& coordinator_;
  const Pools pools_;
  StreamLimits& streams_;
  const auth::Admission admission_;
  const std::optional<base::FairShare::Held> place_;  // its share of streams.uploads
  grpc::ByteBuffer bytes_;
  v1::UploadBlobRequest request_;
  v1::UploadBlobResponse response_;
  // Set from the first chunk on:
  std::optional<blobs::BlobClaims::Use> use_;
  std::optional<blobs::BlobWriter> writer_;

  core::Mutex mutex_;
  // Set while a read is in progress.
  std::optional<Clock::time_point> waiting_since_ TESSERA_GUARDED_BY(mutex_);
  bool ended_ TESSERA_GUARDED_BY(mutex_) = false;  // for lack of progress
};

// Sends one blob from the store to a worker, or one segment of it, or tells the worker which other one has
// that.
class FetchStream final : public RequestCall {
 public:
  FetchStream(grpc::CallbackServerContext& context, server::Coordinator& coordinator, base::ThreadPool& pool,
              StreamLimits& streams, auth::Admission admission)
      : RequestCall(context, streams, std::move(admission)), coordinator_(coordinator), pool_(pool) {}

 private:
  google::protobuf::Message& message() override { return request_; }
  void begin() override;
  void OnWriteDone(bool ok) override;
  void end_own_wait_since(Clock::time_point time) override;

  core::Status open();
  // Of the answer to a request for a segment: chooses where it comes from.
  void answer_segment_request();
  core::Status begin_segment(blobs::SegmentTracker::Sending sending);
  // Sends the response, which is all, and ends the call.
  void answer_at_once();
  void write_next();
  // Ends the call, and reports a lost blob to the coordinator.
  void fail(const core::Error& error);

  server::Coordinator& coordinator_;
  base::ThreadPool& pool_;
  v1::FetchBlobRequest request_;
  std::optional<base::FairShare::Held> place_;  // its share of streams.fetches
  v1::FetchBlobResponse response_;
  grpc::ByteBuffer bytes_;
  proto::Digest digest_;
  std::optional<blobs::BlobReader> reader_;
  std::optional<blobs::SegmentTracker::Sending> sending_;  // the segment, unless it is a whole blob

  core::Mutex mutex_;
  // Set while a write is in progress.
  std::optional<Clock::time_point> waiting_since_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::rpc
