// SPDX-License-Identifier: Apache-2.0
#include "proto/listening_sockets.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace tessera::proto {

using core::ErrorCode;
using core::OpenFile;

namespace {

// The kernel uses less if its own limit is lower (net.core.somaxconn).
constexpr int kBacklog = 4096;
// A port that is free at one address of the host may be taken at another.
constexpr int kPicks = 16;

tl::unexpected<core::Error> cannot_listen(ErrorCode code, const std::string& address, std::string_view why) {
  return core::fail(code, fmt::format("cannot listen on {}: {}", address, why));
}

struct HostPort {
  std::string host;
  std::uint16_t port;
};

std::optional<HostPort> parse(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  HostPort parsed{address.substr(0, colon), 0};
  const char* end = address.data() + address.size();
  const auto [rest, error] = std::from_chars(address.data() + colon + 1, end, parsed.port);
  if (error != std::errc() || rest != end) return std::nullopt;
  std::string& host = parsed.host;
  if (host.size() > 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  else if (host.find(':') != std::string::npos)
    return std::nullopt;  // an IPv6 address without brackets
  if (host.empty()) return std::nullopt;
  return parsed;
}

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

// Null, with an error of getaddrinfo(), if the host has no address.
Addresses look_up(const HostPort& at, int& error) {
  const bool is_wildcard = at.host == "0.0.0.0" || at.host == "::";
  addrinfo hints{};
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  error =
      getaddrinfo(is_wildcard ? nullptr : at.host.c_str(), std::to_string(at.port).c_str(), &hints, &found);
  return {error == 0 ? found : nullptr, &freeaddrinfo};
}

void set_port(sockaddr_storage& address, int port) {
  const auto value = htons(static_cast<std::uint16_t>(port));
  if (address.ss_family == AF_INET) reinterpret_cast<sockaddr_in&>(address).sin_port = value;
  if (address.ss_family == AF_INET6) reinterpret_cast<sockaddr_in6&>(address).sin6_port = value;
}

int port_of(const OpenFile& socket) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  if (getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &length) != 0) return 0;
  return ntohs(address.ss_family == AF_INET ? reinterpret_cast<sockaddr_in&>(address).sin_port
                                            : reinterpret_cast<sockaddr_in6&>(address).sin6_port);
}

bool set_option(const OpenFile& socket, int level, int option, int value) {
  return setsockopt(socket.get(), level, option, &value, sizeof value) == 0;
}

// Invalid, with errno, on failure. SO_REUSEPORT is not set: a second process on the port is an error to
// report, not a load balancer. Connections inherit the TCP options.
OpenFile listen_at(const addrinfo& entry, int port, std::chrono::milliseconds unacknowledged) {
  sockaddr_storage address{};
  std::memcpy(&address, entry.ai_addr, entry.ai_addrlen);
  if (port != 0) set_port(address, port);
  OpenFile socket(::socket(entry.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const bool listens =
      socket && set_option(socket, SOL_SOCKET, SO_REUSEADDR, 1) &&
      (entry.ai_family != AF_INET6 || set_option(socket, IPPROTO_IPV6, IPV6_V6ONLY, 1)) &&
      set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1) &&
      set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(unacknowledged.count())) &&
      ::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), entry.ai_addrlen) == 0 &&
      ::listen(socket.get(), kBacklog) == 0;
  if (listens) return socket;
  const int error = errno;
  socket = OpenFile();
  errno = error;
  return {};
}

// Listens at every address of this machine with the same port. Returns 0 or errno.
int listen_at_each(const addrinfo* entries, std::chrono::milliseconds unacknowledged,
                   ListeningSockets& made) {
  std::set<std::string> seen;  // a name may resolve to the same address twice
  int error = EADDRNOTAVAIL;
  for (const addrinfo* entry = entries; entry != nullptr; entry = entry->ai_next) {
    if (!seen.emplace(reinterpret_cast<const char*>(entry->ai_addr), entry->ai_addrlen).second) continue;
    OpenFile socket = listen_at(*entry, made.port, unacknowledged);
    if (!socket) {
      error = errno;
      if (error == EADDRINUSE) return error;
      continue;  // e.g. IPv6 on a machine without it
    }
    if (made.port == 0) made.port = port_of(socket);
    made.sockets.push_back(std::move(socket));
  }
  return made.sockets.empty() ? error : 0;
}

}  // namespace

ListeningSockets adopt(std::vector<OpenFile> sockets, std::chrono::milliseconds unacknowledged) {
  for (const OpenFile& socket : sockets) {
    set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
    set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(unacknowledged.count()));
  }
  const int port = port_of(sockets.front());
  return {std::move(sockets), port};
}

core::Result<ListeningSockets> listen_on(const std::string& address,
                                         std::chrono::milliseconds unacknowledged) {
  const auto at = parse(address);
  if (!at)
    return cannot_listen(ErrorCode::kInvalidArgument, address,
                         "it is not HOST:PORT, such as 0.0.0.0:7420 or [::1]:7420");
  int unknown = 0;
  const Addresses found = look_up(*at, unknown);
  if (!found) return cannot_listen(ErrorCode::kInvalidArgument, address, gai_strerror(unknown));
  int error = 0;
  for (int i = 0; i < kPicks; ++i) {
    ListeningSockets made;
    error = listen_at_each(found.get(), unacknowledged, made);
    if (error == 0) return made;
    if (error != EADDRINUSE || at->port != 0) break;
  }
  if (error == EADDRINUSE)
    return cannot_listen(ErrorCode::kUnavailable, address,
                         "another program listens there; end it, or choose another port");
  const ErrorCode code = error == EADDRNOTAVAIL ? ErrorCode::kInvalidArgument : ErrorCode::kUnavailable;
  return cannot_listen(code, address, std::strerror(error));
}

}  // namespace tessera::proto
