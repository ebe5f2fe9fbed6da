// SPDX-License-Identifier: Apache-2.0
// The sockets that a coordinator listens at. Thread-safe: nothing here is shared.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/store/file.hpp"

namespace tessera::rpc {

struct ListeningSockets {
  std::vector<store::Fd> sockets;  // non-blocking; one for each address of the host
  int port = 0;                    // of all of them
};

// At HOST:PORT, where an IPv6 address stands in brackets; port 0 picks a free one, and a wildcard of either
// kind is for IPv4 and IPv6. A connection whose peer leaves bytes unacknowledged for so long is given up.
// UNAVAILABLE if somebody else listens at any of the host's addresses; INVALID_ARGUMENT if it is no HOST:PORT
// of this machine.
core::Result<ListeningSockets> listen_on(const std::string& address,
                                         std::chrono::milliseconds unacknowledged);

}  // namespace tessera::rpc
