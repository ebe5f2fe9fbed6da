// SPDX-License-Identifier: Apache-2.0
#include "proto/peer_address.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <regex>

namespace tessera::proto {

namespace {

constexpr std::size_t kNetworkBytes = 8;  // of an IPv6 address

}  // namespace

std::string address_key(const sockaddr_storage& peer) {
  char text[INET6_ADDRSTRLEN] = "";
  if (peer.ss_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(peer).sin_addr, text, sizeof text);
    return text;
  }
  in6_addr network = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
  std::fill(std::begin(network.s6_addr) + kNetworkBytes, std::end(network.s6_addr), std::uint8_t{0});
  inet_ntop(AF_INET6, &network, text, sizeof text);
  return std::string(text) + "/64";
}

std::string address_key(const std::string& peer) {
  if (peer.starts_with("ipv4:")) return peer.substr(0, peer.find_last_of(':'));  // the common case
  static const std::regex kIpv6(R"(ipv6:(?:\[|%5B)([0-9a-f:.]+)(?:\]|%5D):\d+)", std::regex::icase);
  std::smatch parts;
  sockaddr_storage address{};
  auto& ipv6 = reinterpret_cast<sockaddr_in6&>(address);
  ipv6.sin6_family = AF_INET6;
  if (std::regex_match(peer, parts, kIpv6) && inet_pton(AF_INET6, parts.str(1).c_str(), &ipv6.sin6_addr) == 1)
    return address_key(address);
  return peer.substr(0, peer.find_last_of(':'));
}

std::string host_of(const std::string& peer) {
  static const std::regex kIpv4(R"(ipv4:([0-9.]+):\d+)");
  static const std::regex kMapped(R"(ipv6:(?:\[|%5B)::ffff:([0-9.]+)(?:\]|%5D):\d+)", std::regex::icase);
  static const std::regex kIpv6(R"(ipv6:(?:\[|%5B)([0-9a-f:.]+)(?:\]|%5D):\d+)", std::regex::icase);
  std::smatch parts;
  if (std::regex_match(peer, parts, kIpv4) || std::regex_match(peer, parts, kMapped)) return parts.str(1);
  if (std::regex_match(peer, parts, kIpv6)) return "[" + parts.str(1) + "]";
  return "";
}

bool is_loopback_host(const std::string& host) {
  return host.starts_with("127.") || host == "[::1]";
}

std::string client_machine(const sockaddr_storage& peer) {
  if (peer.ss_family == AF_INET) return "ipv4:" + address_key(peer);
  const auto& ipv6 = reinterpret_cast<const sockaddr_in6&>(peer);
  if (!IN6_IS_ADDR_V4MAPPED(&ipv6.sin6_addr)) return address_key(peer);
  sockaddr_storage mapped{};
  auto& ipv4 = reinterpret_cast<sockaddr_in&>(mapped);
  ipv4.sin_family = AF_INET;
  std::memcpy(&ipv4.sin_addr, ipv6.sin6_addr.s6_addr + 12, sizeof ipv4.sin_addr);
  return client_machine(mapped);
}

}  // namespace tessera::proto
