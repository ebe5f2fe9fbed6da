// SPDX-License-Identifier: Apache-2.0
// Fetches segments of blobs from other workers, and remembers those that failed to send them. Not
// thread-safe.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "proto/blob.hpp"
#include "proto/segments.hpp"
#include "tessera/v1/peer_service.grpc.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::worker {

class PeerClient {
 public:
  using Clock = std::chrono::steady_clock;
  // A worker that did not answer, or did not have the segment, is excluded for this time; one that sent wrong
  // bytes for as long as this process runs.
  static constexpr std::chrono::minutes kExcludedFor{1};
  static constexpr std::size_t kMaxExcluded = 64;

  // The bytes of the segment, verified. Any error excludes the worker. Blocks, for a minute at most; returns
  // soon after a stop. DATA_LOSS: it sent other bytes.
  core::Result<std::string> fetch(const proto::Digest& blob, const v1::PeerReferral& referral,
                                  const std::stop_token& stop);

  // The ids of the workers that the coordinator is asked not to name.
  std::vector<std::string> excluded(Clock::time_point now);

 private:
  struct Connection {
    std::string address, certificate_pem;
    std::unique_ptr<v1::PeerService::StubInterface> stub;
  };

  core::Result<std::string> receive(const proto::Digest& blob, const v1::PeerReferral& referral,
                                    const std::stop_token& stop);
  v1::PeerService::StubInterface& connect(const v1::PeerReferral& referral);
  void exclude(const std::string& worker_id, const core::Error& error);

  std::map<std::string, Connection> connections_;                     // by worker id
  std::map<std::string, std::optional<Clock::time_point>> excluded_;  // until then; empty: for ever
};

}  // namespace tessera::worker
