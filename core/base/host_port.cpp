// SPDX-License-Identifier: Apache-2.0
#include "core/base/host_port.hpp"

#include <arpa/inet.h>

#include <charconv>

namespace tessera::core {
namespace {

bool is_ip(int family, const std::string& host) {
  in6_addr parsed{};
  return inet_pton(family, host.c_str(), &parsed) == 1;
}

std::optional<HostPort> parse_host(const std::string& host) {
  if (host == "localhost") return HostPort{"127.0.0.1"};
  if (is_ip(AF_INET, host)) return HostPort{host};
  if (host.size() < 3 || host.front() != '[' || host.back() != ']') return std::nullopt;
  const std::string inner = host.substr(1, host.size() - 2);
  if (!is_ip(AF_INET6, inner)) return std::nullopt;
  return HostPort{inner, true};
}

}  // namespace

std::optional<HostPort> parse_host_port(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  std::optional<HostPort> parsed = parse_host(address.substr(0, colon));
  if (!parsed) return std::nullopt;
  const char* const begin = address.data() + colon + 1;
  const char* const end = address.data() + address.size();
  const auto [rest, wrong] = std::from_chars(begin, end, parsed->port);
  if (wrong != std::errc() || rest != end) return std::nullopt;
  return parsed;
}

bool is_loopback(const HostPort& address) {
  return address.is_ipv6 ? address.host == "::1" : address.host.starts_with("127.");
}

}  // namespace tessera::core
