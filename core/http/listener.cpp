// SPDX-License-Identifier: Apache-2.0
#include "core/http/listener.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/host_port.hpp"

namespace tessera::http {
namespace {

// An address as the calls of the system want it.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = sizeof(sockaddr_storage);

  sockaddr* get() { return static_cast<sockaddr*>(static_cast<void*>(&storage)); }
};

SocketAddress to_socket_address(const core::HostPort& at) {
  SocketAddress address;
  if (at.is_ipv6) {
    sockaddr_in6 v6{};
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(at.port);
    inet_pton(AF_INET6, at.host.c_str(), &v6.sin6_addr);
    std::memcpy(&address.storage, &v6, sizeof v6);
    address.size = sizeof v6;
  } else {
    sockaddr_in v4{};
    v4.sin_family = AF_INET;
    v4.sin_port = htons(at.port);
    inet_pton(AF_INET, at.host.c_str(), &v4.sin_addr);
    std::memcpy(&address.storage, &v4, sizeof v4);
    address.size = sizeof v4;
  }
  return address;
}

int port_of(int socket) {
  SocketAddress bound;
  if (::getsockname(socket, bound.get(), &bound.size) != 0) return 0;
  if (bound.storage.ss_family == AF_INET6) {
    sockaddr_in6 v6{};
    std::memcpy(&v6, &bound.storage, sizeof v6);
    return ntohs(v6.sin6_port);
  }
  sockaddr_in v4{};
  std::memcpy(&v4, &bound.storage, sizeof v4);
  return ntohs(v4.sin_port);
}

tl::unexpected<core::Error> cannot_listen(const std::string& address, int error) {
  return core::fail(core::ErrorCode::kUnavailable,
                    fmt::format("cannot listen on {}: {}", address, std::strerror(error)));
}

}  // namespace

core::Result<Listener> listen_on(const std::string& address) {
  const auto at = core::parse_host_port(address);
  if (!at)
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("must be HOST:PORT with localhost or an IP address, such as 127.0.0.1:8080 "
                                  "or [::1]:8080, got '{}'",
                                  address));
  const int family = at->is_ipv6 ? AF_INET6 : AF_INET;
  const int socket = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return cannot_listen(address, errno);
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  SocketAddress wanted = to_socket_address(*at);
  if (::bind(socket, wanted.get(), wanted.size) != 0 || ::listen(socket, SOMAXCONN) != 0) {
    const int error = errno;
    ::close(socket);
    return cannot_listen(address, error);
  }
  const std::string host = address.substr(0, address.rfind(':'));
  return Listener{socket, fmt::format("{}:{}", host, port_of(socket))};
}

}  // namespace tessera::http
