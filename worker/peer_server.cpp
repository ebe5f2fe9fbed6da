// SPDX-License-Identifier: Apache-2.0
#include "worker/peer_server.hpp"

#include <fmt/format.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/security/server_credentials.h>
#include <openssl/rand.h>

#include <chrono>
#include <string_view>
#include <utility>

#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "proto/peer_address.hpp"
#include "proto/peer_ticket.hpp"
#include "proto/segments.hpp"
#include "proto/status.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {

namespace {

constexpr int kMaxRequestBytes = 4 << 10;
constexpr std::size_t kMaxMemoryBytes = std::size_t{64} << 20;
// Beside those that send, threads that refuse.
constexpr int kMaxServerThreads = static_cast<int>(UploadQuota::kMaxUploads) + 8;
// The coordinator names a worker when it has sent the segment, which is then on its way.
constexpr std::chrono::seconds kMaxWaitForSegment{2};
constexpr std::chrono::seconds kMaxReaderSilence{10};

std::uint64_t clock_seconds() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(now).count());
}

}  // namespace

PeerServer::PeerServer(const BlobCache& cache, PeerCertificate certificate, std::string ticket_key)
    : cache_(cache), certificate_(std::move(certificate)), ticket_key_(std::move(ticket_key)) {}

core::Result<std::unique_ptr<PeerServer>> PeerServer::start(const std::string& address,
                                                            const BlobCache& cache,
                                                            const PeerLimits& limits) {
  const auto option = fmt::format("--serve-blobs {}", address);
  std::string key(proto::kTicketKeyBytes, '\0');
  if (RAND_bytes(reinterpret_cast<unsigned char*>(key.data()), static_cast<int>(key.size())) != 1)
    return core::fail(core::ErrorCode::kInternal, "OpenSSL has no random numbers");
  auto listening = proto::listen_on(address, proto::Patience().answer);
  if (!listening) return core::fail(listening.error().within(option));
  auto listener =
      proto::Listener::make(std::move(*listening), {limits.connections, limits.machine_connections}, {});
  if (!listener) return core::fail(listener.error().within(option));
  std::unique_ptr<PeerServer> self(new PeerServer(cache, make_peer_certificate(), std::move(key)));
  self->listener_ = std::move(*listener);
  if (const auto served = self->serve(limits); !served) return core::fail(served.error().within(option));
  return self;
}

core::Status PeerServer::serve(const PeerLimits& limits) {
  grpc::SslServerCredentialsOptions tls;
  tls.pem_key_cert_pairs.push_back({certificate_.key_pem, certificate_.certificate_pem});
  grpc::ServerBuilder builder;
  proto::apply_server_options(builder, {},
                              {.message_bytes = kMaxRequestBytes, .quota_bytes = kMaxMemoryBytes});
  builder.SetResourceQuota(
      grpc::ResourceQuota("peers").Resize(kMaxMemoryBytes).SetMaxThreads(kMaxServerThreads));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, static_cast<int>(limits.idle.count()));
  builder.RegisterService(this);
  acceptor_ = builder.experimental().AddExternalConnectionAcceptor(
      grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD,
      grpc::SslServerCredentials(tls));
  server_ = builder.BuildAndStart();
  if (!server_) return core::fail(core::ErrorCode::kInternal, "gRPC does not start");
  listener_->start([this](int descriptor) {
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
    connection.fd = descriptor;
    acceptor_->HandleNewConnection(&connection);
  });
  return {};
}

PeerServer::~PeerServer() {
  listener_->stop();
  if (server_) server_->Shutdown(std::chrono::system_clock::now());
}

v1::PeerEndpoint PeerServer::endpoint() const {
  v1::PeerEndpoint endpoint;
  endpoint.set_port(static_cast<std::uint32_t>(listener_->port()));
  endpoint.set_certificate_pem(certificate_.certificate_pem);
  endpoint.set_ticket_key(ticket_key_);
  endpoint.set_clock_seconds(clock_seconds());
  return endpoint;
}

grpc::Status PeerServer::FetchSegment(grpc::ServerContext* context, const v1::FetchSegmentRequest* request,
                                      grpc::ServerWriter<v1::FetchSegmentResponse>* writer) {
  try {
    return send(*context, *request, *writer);
  } catch (const std::bad_alloc&) {
    return {grpc::StatusCode::RESOURCE_EXHAUSTED, "not enough memory"};
  }
}

grpc::Status PeerServer::send(grpc::ServerContext& context, const v1::FetchSegmentRequest& request,
                              grpc::ServerWriter<v1::FetchSegmentResponse>& writer) {
  const auto digest = proto::from_proto(request.digest());
  if (!digest) return proto::to_grpc(digest.error());
  const auto segment = proto::from_proto(request.segment(), digest->size_bytes);
  if (!segment) return proto::to_grpc(segment.error());
  const std::uint64_t now = clock_seconds();
  if (!proto::is_valid(request.ticket(), ticket_key_, *digest, *segment, now))
    return {grpc::StatusCode::PERMISSION_DENIED, "the ticket is not for this segment, or has expired"};
  const auto upload = quota_.begin(proto::address_key(context.peer()), request.ticket(), now);
  if (!upload) return proto::to_grpc(upload.error());
  const auto bytes = cache_.read_segment(*digest, *segment, kMaxWaitForSegment);
  if (!bytes) return {grpc::StatusCode::NOT_FOUND, "this worker does not have the segment"};
  StallGuard guard([&] { context.TryCancel(); }, kMaxReaderSilence);
  std::string_view rest = *bytes;
  v1::FetchSegmentResponse response;
  while (!rest.empty()) {
    const std::string_view piece = rest.substr(0, proto::kChunkBytes);
    response.set_data(piece.data(), piece.size());
    if (!writer.Write(response)) return grpc::Status::CANCELLED;
    guard.progressed();
    rest.remove_prefix(piece.size());
  }
  cache_.traffic().peer_sent_bytes += bytes->size();
  return grpc::Status::OK;
}

}  // namespace tessera::worker
