// SPDX-License-Identifier: Apache-2.0
#include "core/common/passed_sockets.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/printable.hpp"

namespace tessera::common {
namespace {

// More than any unit has.
constexpr int kMaxSockets = 64;

// The value of a variable that this process need not pass on; empty if there is none.
std::string take_variable(const char* name) {
  const char* const value = std::getenv(name);
  std::string taken = value == nullptr ? "" : value;
  ::unsetenv(name);
  return taken;
}

int to_number(std::string_view text) {
  int number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && rest == text.data() + text.size() ? number : 0;
}

// The name of descriptor `index` in a list with colons.
std::string name_at(std::string_view names, int index) {
  for (; index > 0; --index) {
    const std::size_t colon = names.find(':');
    if (colon == std::string_view::npos) return "";
    names.remove_prefix(colon + 1);
  }
  return std::string(names.substr(0, names.find(':')));
}

bool listens(int descriptor) {
  int accepts = 0;
  socklen_t size = sizeof accepts;
  return ::getsockopt(descriptor, SOL_SOCKET, SO_ACCEPTCONN, &accepts, &size) == 0 && accepts != 0;
}

// Nothing if it is no address of IPv4 or IPv6.
std::optional<std::string> address_of(int descriptor) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) return std::nullopt;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address.ss_family == AF_INET) {
    const auto& v4 = reinterpret_cast<const sockaddr_in&>(address);
    ::inet_ntop(AF_INET, &v4.sin_addr, text.data(), text.size());
    return fmt::format("{}:{}", text.data(), ntohs(v4.sin_port));
  }
  if (address.ss_family != AF_INET6) return std::nullopt;
  const auto& v6 = reinterpret_cast<const sockaddr_in6&>(address);
  ::inet_ntop(AF_INET6, &v6.sin6_addr, text.data(), text.size());
  return fmt::format("[{}]:{}", text.data(), ntohs(v6.sin6_port));
}

}  // namespace

core::Result<std::vector<PassedSocket>> take_passed_sockets(int first_descriptor) {
  const std::string process = take_variable("LISTEN_PID"), count = take_variable("LISTEN_FDS");
  const std::string names = take_variable("LISTEN_FDNAMES");
  std::vector<PassedSocket> sockets;
  if (to_number(process) != ::getpid()) return sockets;
  for (int i = 0; i < std::min(to_number(count), kMaxSockets); ++i) {
    PassedSocket socket{name_at(names, i), "", first_descriptor + i};
    auto address = listens(socket.descriptor) ? address_of(socket.descriptor) : std::nullopt;
    if (!address)
      return core::fail(
          core::ErrorCode::kInvalidArgument,
          fmt::format("the service manager has passed on descriptor {} ('{}'), which is no listening TCP "
                      "socket: use ListenStream= with an address and a port",
                      socket.descriptor, core::printable(socket.name)));
    socket.address = *std::move(address);
    ::fcntl(socket.descriptor, F_SETFD, FD_CLOEXEC);
    ::fcntl(socket.descriptor, F_SETFL, ::fcntl(socket.descriptor, F_GETFL) | O_NONBLOCK);
    sockets.push_back(std::move(socket));
  }
  return sockets;
}

}  // namespace tessera::common
