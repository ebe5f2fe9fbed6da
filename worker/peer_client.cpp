// SPDX-License-Identifier: Apache-2.0
#include "worker/peer_client.hpp"

#include <fmt/format.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "proto/peer_ticket.hpp"
#include "proto/status.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {

namespace {

using core::ErrorCode;

// A segment takes longer only on lines of less than 70 KB/s; it then comes from the coordinator.
constexpr std::chrono::minutes kMaxTime{1};
constexpr std::chrono::seconds kMaxPeerSilence{10};
constexpr int kConnectTimeMs = 3'000;
constexpr int kPeerKeepaliveMs = 10'000;
constexpr std::size_t kMaxConnections = 64;
constexpr int kWindowBytes = 1 << 20;

grpc::ChannelArguments peer_arguments() {
  grpc::ChannelArguments arguments;
  arguments.SetSslTargetNameOverride(proto::kPeerName);
  arguments.SetMaxReceiveMessageSize(static_cast<int>(2 * proto::kMaxChunkBytes));
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kPeerKeepaliveMs);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kConnectTimeMs);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kConnectTimeMs);
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kWindowBytes);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return arguments;
}

}  // namespace

core::Result<std::string> PeerClient::fetch(const proto::Digest& blob, const v1::PeerReferral& referral,
                                            const std::stop_token& stop) {
  auto bytes = receive(blob, referral, stop);
  if (!bytes && !stop.stop_requested()) exclude(referral.worker_id(), bytes.error());
  return bytes;
}

core::Result<std::string> PeerClient::receive(const proto::Digest& blob, const v1::PeerReferral& referral,
                                              const std::stop_token& stop) {
  StoppableCall call(stop, kMaxTime);
  StallGuard guard([&] { call.context()->TryCancel(); }, kMaxPeerSilence);
  v1::FetchSegmentRequest request;
  *request.mutable_digest() = proto::to_proto(blob);
  *request.mutable_segment() = referral.segment();
  *request.mutable_ticket() = referral.ticket();
  const auto stream = connect(referral).FetchSegment(call.context(), request);
  const std::uint64_t size = referral.segment().size_bytes();
  std::string bytes;
  v1::FetchSegmentResponse response;
  bool fits = true;
  while (fits && stream->Read(&response)) {
    guard.progressed();
    fits = response.data().size() <= size - bytes.size();
    if (fits) bytes += response.data();
  }
  if (!fits) call.context()->TryCancel();
  const grpc::Status finished = stream->Finish();
  if (fits && !finished.ok()) return core::fail(proto::error_from_grpc(finished));
  const auto sha256 = proto::digest_of(bytes).sha256;
  if (fits && std::equal(sha256.begin(), sha256.end(), referral.segment_sha256().begin(),
                         referral.segment_sha256().end(),
                         [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }))
    return bytes;
  return core::fail(ErrorCode::kDataLoss, "it sent other bytes than those of the file");
}

v1::PeerService::StubInterface& PeerClient::connect(const v1::PeerReferral& referral) {
  if (connections_.size() >= kMaxConnections && !connections_.contains(referral.worker_id()))
    connections_.clear();
  Connection& connection = connections_[referral.worker_id()];
  if (connection.stub && connection.address == referral.address() &&
      connection.certificate_pem == referral.certificate_pem())
    return *connection.stub;
  grpc::SslCredentialsOptions tls;
  tls.pem_root_certs = referral.certificate_pem();
  connection = {referral.address(), referral.certificate_pem(),
                v1::PeerService::NewStub(grpc::CreateCustomChannel(
                    referral.address(), grpc::SslCredentials(tls), peer_arguments()))};
  return *connection.stub;
}

void PeerClient::exclude(const std::string& worker_id, const core::Error& error) {
  const bool is_wrong = error.code == ErrorCode::kDataLoss;
  spdlog::log(is_wrong ? spdlog::level::warn : spdlog::level::debug, "a part of a file from worker {}: {}",
              worker_id, error.message);
  connections_.erase(worker_id);
  const std::optional<Clock::time_point> until =
      is_wrong ? std::nullopt : std::optional(Clock::now() + kExcludedFor);
  if (excluded_.size() >= kMaxExcluded && !excluded_.contains(worker_id)) {
    // Empty, for ever, would be the smallest.
    const auto soonest =
        std::min_element(excluded_.begin(), excluded_.end(), [](const auto& a, const auto& b) {
          return a.second.value_or(Clock::time_point::max()) < b.second.value_or(Clock::time_point::max());
        });
    excluded_.erase(soonest);
  }
  excluded_[worker_id] = until;
}

std::vector<std::string> PeerClient::excluded(Clock::time_point now) {
  std::erase_if(excluded_, [&](const auto& entry) { return entry.second && *entry.second <= now; });
  std::vector<std::string> ids;
  for (const auto& [worker_id, until] : excluded_) ids.push_back(worker_id);
  return ids;
}

}  // namespace tessera::worker
