// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/segment_requests.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include "proto/peer_address.hpp"
#include "proto/peer_ticket.hpp"
#include "proto/segments.hpp"
#include "proto/worker_key.hpp"

namespace tessera::rpc {

using core::ErrorCode;

namespace {

constexpr std::size_t kMaxCertificateBytes = 4 << 10;
constexpr std::uint32_t kMaxPort = 65535;

// Where the caller serves others. Empty if it does not, or if its host is not known.
core::Result<std::optional<blobs::SegmentTracker::Endpoint>> read_endpoint(const v1::SegmentRequest& request,
                                                                           const std::string& host,
                                                                           blobs::SegmentTracker::Time now) {
  if (!request.has_endpoint() || host.empty()) return std::nullopt;
  const v1::PeerEndpoint& endpoint = request.endpoint();
  if (endpoint.port() == 0 || endpoint.port() > kMaxPort)
    return core::fail(ErrorCode::kInvalidArgument, "segment.endpoint.port: must be a port");
  if (endpoint.ticket_key().size() != proto::kTicketKeyBytes)
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("segment.endpoint.ticket_key: must be {} bytes", proto::kTicketKeyBytes));
  if (endpoint.certificate_pem().size() > kMaxCertificateBytes)
    return core::fail(
        ErrorCode::kInvalidArgument,
        fmt::format("segment.endpoint.certificate_pem: must be at most {} bytes", kMaxCertificateBytes));
  return blobs::SegmentTracker::Endpoint{.address = fmt::format("{}:{}", host, endpoint.port()),
                                         .certificate_pem = endpoint.certificate_pem(),
                                         .ticket_key = endpoint.ticket_key(),
                                         .clock_seconds = endpoint.clock_seconds(),
                                         .heard_at = now};
}

}  // namespace

core::Result<blobs::SegmentTracker::Ask> read_segment_request(const v1::SegmentRequest& request,
                                                              const proto::Digest& blob,
                                                              const std::string& peer,
                                                              blobs::SegmentTracker::Time now) {
  if (request.worker_key().size() != proto::kWorkerKeyBytes)
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("segment.worker_key: must be {} bytes", proto::kWorkerKeyBytes));
  auto held = proto::SegmentSet::from_bytes(request.held(), proto::segment_count(blob.size_bytes));
  if (!held) return core::fail(held.error());
  if (held->is_full()) return core::fail(ErrorCode::kInvalidArgument, "segment.held: no segment is missing");
  const std::string host = proto::host_of(peer);
  auto endpoint = read_endpoint(request, host, now);
  if (!endpoint) return core::fail(endpoint.error());
  return blobs::SegmentTracker::Ask{
      .worker_id = proto::worker_id_of(request.worker_key()),
      .endpoint = *std::move(endpoint),
      .is_on_loopback = proto::is_loopback_host(host),
      .blob = blob,
      .held = *std::move(held),
      .excluded = {request.excluded_worker_ids().begin(), request.excluded_worker_ids().end()}};
}

v1::PeerReferral referral_to(const blobs::SegmentTracker::Peer& peer, const proto::Digest& blob,
                             blobs::SegmentTracker::Time now) {
  const blobs::SegmentTracker::Endpoint& endpoint = peer.endpoint;
  const proto::Segment segment = proto::segment_at(blob.size_bytes, peer.index);
  const auto since = std::chrono::duration_cast<std::chrono::seconds>(now - endpoint.heard_at);
  const std::uint64_t clock_seconds = endpoint.clock_seconds + static_cast<std::uint64_t>(since.count());
  v1::PeerReferral referral;
  *referral.mutable_segment() = proto::to_proto(segment);
  referral.set_segment_sha256(peer.sha256.data(), peer.sha256.size());
  referral.set_worker_id(peer.worker_id);
  referral.set_address(endpoint.address);
  referral.set_certificate_pem(endpoint.certificate_pem);
  *referral.mutable_ticket() =
      proto::sign_ticket(endpoint.ticket_key, blob, segment, clock_seconds + proto::kTicketSeconds);
  return referral;
}

}  // namespace tessera::rpc
