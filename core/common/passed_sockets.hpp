// SPDX-License-Identifier: Apache-2.0
// Listening sockets of the service manager, by the protocol of sd_listen_fds(3): LISTEN_PID, LISTEN_FDS and
// LISTEN_FDNAMES. Not thread-safe: they are taken before other threads start.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::common {

struct PassedSocket {
  std::string name;     // FileDescriptorName= of the unit
  std::string address;  // HOST:PORT at which it listens, an IPv6 address in brackets
  int descriptor = -1;  // owned by whoever has the list; non-blocking, and not passed on to child processes
};

// Takes the sockets that were passed to this process, and removes the variables. Empty without a manager that
// passes any. INVALID_ARGUMENT names one that is no listening TCP socket.
core::Result<std::vector<PassedSocket>> take_passed_sockets(int first_descriptor = 3);

}  // namespace tessera::common
