// SPDX-License-Identifier: Apache-2.0
// The socket on which a server listens.
#pragma once

#include <string>

#include "core/base/error.hpp"

namespace tessera::http {

struct Listener {
  int socket = -1;      // owned by the caller
  std::string address;  // HOST:PORT with the actual port
};

// INVALID_ARGUMENT if it is no HOST:PORT with localhost or an IP address, UNAVAILABLE if it cannot be bound.
core::Result<Listener> listen_on(const std::string& address);

}  // namespace tessera::http
