// SPDX-License-Identifier: Apache-2.0
// Serves segments of blobs in the cache to other workers. Thread-safe.
#pragma once

#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "proto/listener.hpp"
#include "tessera/v1/peer_service.grpc.pb.h"
#include "worker/blob_cache.hpp"
#include "worker/peer_certificate.hpp"
#include "worker/upload_quota.hpp"

namespace tessera::worker {

// The limits on connections. Those beyond the numbers are closed at once, and one without a call after
// `idle`: other workers connect again when they need to.
struct PeerLimits {
  std::size_t connections = 256, machine_connections = 64;
  std::chrono::milliseconds idle = std::chrono::minutes(1);
};

class PeerServer final : private v1::PeerService::Service {
 public:
  // Listens at HOST:PORT; port 0 picks a free one. The cache must outlive it. Errors are those of
  // proto::listen_on().
  static core::Result<std::unique_ptr<PeerServer>> start(const std::string& address, const BlobCache& cache,
                                                         const PeerLimits& limits = {});
  ~PeerServer() override;

  // What the coordinator is told, with the present time of the clock.
  v1::PeerEndpoint endpoint() const;

 private:
  PeerServer(const BlobCache& cache, PeerCertificate certificate, std::string ticket_key);
  core::Status serve(const PeerLimits& limits);
  grpc::Status FetchSegment(grpc::ServerContext* context, const v1::FetchSegmentRequest* request,
                            grpc::ServerWriter<v1::FetchSegmentResponse>* writer) override;
  grpc::Status send(grpc::ServerContext& context, const v1::FetchSegmentRequest& request,
                    grpc::ServerWriter<v1::FetchSegmentResponse>& writer);

  const BlobCache& cache_;
  const PeerCertificate certificate_;
  const std::string ticket_key_;
  UploadQuota quota_;
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<proto::Listener> listener_;  // passes connections to the acceptor
};

}  // namespace tessera::worker
