// SPDX-License-Identifier: Apache-2.0
// Serves segments of blobs in the cache to other workers. Thread-safe.
#pragma once

#include <grpcpp/server.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "tessera/v1/peer_service.grpc.pb.h"
#include "worker/blob_cache.hpp"
#include "worker/peer_certificate.hpp"

namespace tessera::worker {

class PeerServer final : private v1::PeerService::Service {
 public:
  // Segments that are sent at a time.
  static constexpr unsigned kMaxUploads = 8;

  // Listens at HOST:PORT, an IP address; port 0 picks a free one. The cache must outlive it. INVALID_ARGUMENT
  // if that is not possible.
  static core::Result<std::unique_ptr<PeerServer>> start(const std::string& address, const BlobCache& cache);
  ~PeerServer() override;

  // What the coordinator is told, with the present time of the clock.
  v1::PeerEndpoint endpoint() const;

 private:
  PeerServer(const BlobCache& cache, PeerCertificate certificate, std::string ticket_key);
  grpc::Status FetchSegment(grpc::ServerContext* context, const v1::FetchSegmentRequest* request,
                            grpc::ServerWriter<v1::FetchSegmentResponse>* writer) override;
  grpc::Status send(grpc::ServerContext& context, const v1::FetchSegmentRequest& request,
                    grpc::ServerWriter<v1::FetchSegmentResponse>& writer);

  const BlobCache& cache_;
  const PeerCertificate certificate_;
  const std::string ticket_key_;
  std::atomic<unsigned> uploads_{0};
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace tessera::worker
