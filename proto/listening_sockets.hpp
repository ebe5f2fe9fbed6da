// SPDX-License-Identifier: Apache-2.0
// The sockets that a server listens at. Thread-safe: there is no shared state.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"

namespace tessera::proto {

struct ListeningSockets {
  std::vector<core::OpenFile> sockets;  // non-blocking; one for each address of the host
  int port = 0;                         // the same for all of them
};

// Listens at HOST:PORT, with an IPv6 address in brackets. Port 0 picks a free one, and a wildcard address of
// either family listens for IPv4 and IPv6. A connection is dropped if its peer leaves bytes unacknowledged
// for longer than `unacknowledged`. UNAVAILABLE if another process listens at one of the host's addresses;
// INVALID_ARGUMENT if the address is not a HOST:PORT of this machine.
core::Result<ListeningSockets> listen_on(const std::string& address,
                                         std::chrono::milliseconds unacknowledged);

// Takes over sockets that listen already, at least one. They get the same options.
ListeningSockets adopt(std::vector<core::OpenFile> sockets, std::chrono::milliseconds unacknowledged);

}  // namespace tessera::proto
