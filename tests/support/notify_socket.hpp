// SPDX-License-Identifier: Apache-2.0
// The socket of a service manager, as sd_notify(3) describes it. Not thread-safe.
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

#include "core/base/open_file.hpp"

namespace tessera::test {

class NotifySocket {
 public:
  // `name`: a path that does not exist, or '@' and a name outside of the file system, for NOTIFY_SOCKET.
  explicit NotifySocket(const std::string& name) : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    if (name.front() == '@') address.sun_path[0] = '\0';
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    if (::bind(socket_.get(), reinterpret_cast<sockaddr*>(&address), length) != 0)
      throw std::runtime_error("cannot listen at " + name);
  }

  // The next message. Empty if none comes within the timeout.
  std::string receive(int timeout_ms = 60'000) const {
    pollfd ready{.fd = socket_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&ready, 1, timeout_ms) != 1) return "";
    std::array<char, 4096> message{};
    const ssize_t count = ::recv(socket_.get(), message.data(), message.size(), 0);
    return count <= 0 ? "" : std::string(message.data(), static_cast<std::size_t>(count));
  }

  // Whether a message with this text comes, after any number of others.
  bool receives(const std::string& text) const {
    for (std::string message = receive(); !message.empty(); message = receive())
      if (message.find(text) != std::string::npos) return true;
    return false;
  }

 private:
  core::OpenFile socket_;
};

}  // namespace tessera::test
