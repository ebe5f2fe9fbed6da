// SPDX-License-Identifier: Apache-2.0
// Tickets: the coordinator's permission to fetch one segment of a blob from one worker. The worker that
// serves has given the coordinator the key, so it can check a ticket without asking. Pure functions.
#pragma once

#include <cstdint>
#include <string>

#include "proto/blob.hpp"
#include "proto/segments.hpp"

namespace tessera::proto {

inline constexpr std::size_t kTicketKeyBytes = 32;
// How long a ticket is valid, by the clock of the worker that serves.
inline constexpr std::uint64_t kTicketSeconds = 60;
// The name in the certificates of workers that serve.
inline constexpr const char* kPeerName = "tessera-worker";

v1::PeerTicket sign_ticket(const std::string& key, const Digest& blob, const Segment& segment,
                           std::uint64_t expires_seconds);
// Whether the holder of `key` has signed it, and it has not expired at `now_seconds`.
bool is_valid(const v1::PeerTicket& ticket, const std::string& key, const Digest& blob,
              const Segment& segment, std::uint64_t now_seconds);

}  // namespace tessera::proto
