// SPDX-License-Identifier: Apache-2.0
#include "client/tev_connection.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

namespace tessera::client {
namespace {

constexpr int kConnectMilliseconds = 3000;
constexpr int kSendSeconds = 5;

struct HostAndPort {
  std::string host, port;
};

// Of "HOST:PORT", with an IPv6 address in brackets.
std::optional<HostAndPort> split(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == address.size()) return std::nullopt;
  std::string host = address.substr(0, colon), port = address.substr(colon + 1);
  if (port.size() > 5 || port.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  if (std::stoi(port) < 1 || std::stoi(port) > 65535) return std::nullopt;
  if (host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  if (host.empty()) return std::nullopt;
  return HostAndPort{std::move(host), std::move(port)};
}

core::Error no_tev(const std::string& address, const std::string& why) {
  return {core::ErrorCode::kUnavailable,
          fmt::format("no tev at {}: {}; start tev, or name its address (--tev HOST:PORT)", address, why)};
}

// Returns 0 or errno.
int connect_within(int socket, const addrinfo& to, int milliseconds) {
  if (::connect(socket, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd waiting{socket, POLLOUT, 0};
  const int ready = ::poll(&waiting, 1, milliseconds);
  if (ready <= 0) return ready == 0 ? ETIMEDOUT : errno;
  int error = 0;
  socklen_t size = sizeof error;
  return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

void make_blocking(int socket) {
  ::fcntl(socket, F_SETFL, ::fcntl(socket, F_GETFL) & ~O_NONBLOCK);
  const timeval patience{kSendSeconds, 0};
  ::setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
}

}  // namespace

void add_tev_option(CLI::App& command, std::optional<std::string>& address) {
  command
      .add_option_function<std::string>(
          "--tev",
          [&address](const std::string& text) { address = text.empty() ? std::string(kDefaultTev) : text; },
          fmt::format("Show the image in tev, which listens at this address or at {}", kDefaultTev))
      ->expected(0, 1)
      ->type_name("[HOST:PORT]");
}

std::string take_argument(std::optional<std::string>& address) {
  if (!address || split(*address)) return "";
  return std::exchange(*address, std::string(kDefaultTev));
}

core::Result<TevConnection> TevConnection::open(const std::string& address) {
  const auto parts = split(address);
  if (!parts) return core::fail(no_tev(address, "it is not HOST:PORT"));
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  if (const int error = ::getaddrinfo(parts->host.c_str(), parts->port.c_str(), &hints, &found))
    return core::fail(no_tev(address, ::gai_strerror(error)));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> list(found, ::freeaddrinfo);
  int error = 0;
  for (const addrinfo* to = list.get(); to != nullptr; to = to->ai_next) {
    core::OpenFile socket(
        ::socket(to->ai_family, to->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, to->ai_protocol));
    error = socket.valid() ? connect_within(socket.get(), *to, kConnectMilliseconds) : errno;
    if (error != 0) continue;
    make_blocking(socket.get());
    return TevConnection(std::move(socket), address);
  }
  return core::fail(no_tev(address, std::strerror(error)));
}

core::Status TevConnection::send(std::string_view packet) {
  while (!packet.empty()) {
    const ssize_t sent = ::send(socket_.get(), packet.data(), packet.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) {
      const char* why = errno == EAGAIN || errno == EWOULDBLOCK ? "it takes nothing" : std::strerror(errno);
      return core::fail(core::ErrorCode::kUnavailable,
                        fmt::format("lost tev at {} ({}); rendering goes on", address_, why));
    }
    packet.remove_prefix(static_cast<std::size_t>(sent));
  }
  return {};
}

}  // namespace tessera::client
