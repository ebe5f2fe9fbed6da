// SPDX-License-Identifier: Apache-2.0
// Addresses to listen on, as options name them: HOST:PORT with localhost or an IP address, an IPv6 one in
// brackets. Stateless.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tessera::core {

struct HostPort {
  std::string host;  // an IP address, without brackets
  bool is_ipv6 = false;
  std::uint16_t port = 0;
};

// Nothing else than such an address is one: no names to look up, no lists, no missing parts.
std::optional<HostPort> parse_host_port(const std::string& address);

// Whether only this machine reaches it.
bool is_loopback(const HostPort& address);

}  // namespace tessera::core
