// SPDX-License-Identifier: Apache-2.0
// Blobs in segments, which the coordinator sends or tells which worker has. What is there already survives an
// interrupted call. Not thread-safe.
#pragma once

#include <string>
#include <utility>

#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/blob_cache.hpp"
#include "worker/blob_source.hpp"
#include "worker/peer_client.hpp"
#include "worker/peer_server.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {

class SegmentSource final : public BlobSource {
 public:
  // `server` is null for a worker that serves nobody. All but the key must outlive it. Without a key, blobs
  // come whole from the coordinator.
  SegmentSource(std::string worker_key, const BlobCache& cache, v1::WorkerService::StubInterface& coordinator,
                const PeerServer* server)
      : worker_key_(std::move(worker_key)),
        cache_(cache),
        coordinator_(coordinator),
        server_(server),
        whole_(coordinator),
        knows_segments_(!worker_key_.empty()) {}

  // Waits for a coordinator that does not answer.
  core::Status fetch(PartialBlob& into, const std::stop_token& stop) override;

 private:
  core::Status fetch_segments(PartialBlob& into, const std::stop_token& stop);
  // Gets one segment, or learns that none can be had at the moment, and waits a little.
  core::Status fetch_one(PartialBlob& into, const std::stop_token& stop);
  core::Status receive(grpc::ClientReaderInterface<v1::FetchBlobResponse>& stream,
                       v1::FetchBlobResponse& response, PartialBlob& into, StallGuard& guard);
  core::Status follow(const v1::PeerReferral& referral, PartialBlob& into, const std::stop_token& stop);
  v1::FetchBlobRequest request_for(const PartialBlob& blob);

  const std::string worker_key_;
  const BlobCache& cache_;
  v1::WorkerService::StubInterface& coordinator_;
  const PeerServer* const server_;
  CoordinatorSource whole_;
  PeerClient peers_;
  bool knows_segments_;  // the coordinator does, as far as is known
};

}  // namespace tessera::worker
