// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/http/raw_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "core/base/host_port.hpp"

namespace tessera::http {
namespace {

constexpr int kSeconds = 20;

bool connect_to(int socket, const core::HostPort& at) {
  if (at.is_ipv6) {
    sockaddr_in6 v6{};
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(at.port);
    inet_pton(AF_INET6, at.host.c_str(), &v6.sin6_addr);
    return ::connect(socket, reinterpret_cast<const sockaddr*>(&v6), sizeof v6) == 0;
  }
  sockaddr_in v4{};
  v4.sin_family = AF_INET;
  v4.sin_port = htons(at.port);
  inet_pton(AF_INET, at.host.c_str(), &v4.sin_addr);
  return ::connect(socket, reinterpret_cast<const sockaddr*>(&v4), sizeof v4) == 0;
}

}  // namespace

RawClient::RawClient(const std::string& address, int receive_buffer_bytes) {
  const auto at = core::parse_host_port(address);
  if (!at) throw std::runtime_error("no address: " + address);
  socket_ = ::socket(at->is_ipv6 ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval longest{kSeconds, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
  if (receive_buffer_bytes > 0)
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof receive_buffer_bytes);
  if (!connect_to(socket_, *at)) throw std::runtime_error("cannot connect to " + address);
}

RawClient::~RawClient() {
  ::close(socket_);
}

bool RawClient::send(const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

std::string RawClient::receive() {
  std::string bytes(16 << 10, '\0');
  const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
  is_ended_ = count == 0 || (count < 0 && errno == ECONNRESET);
  bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return bytes;
}

std::string RawClient::receive_until(const std::string& text) {
  std::string all;
  while (text.empty() || all.find(text) == std::string::npos) {
    const std::string some = receive();
    if (some.empty()) break;
    all += some;
  }
  return all;
}

std::string get(const std::string& address, const std::string& path, const std::string& headers) {
  RawClient client(address);
  client.send("GET " + path + " HTTP/1.1\r\nHost: test\r\nConnection: close\r\n" + headers + "\r\n");
  return client.receive_all();
}

std::string unchunked(const std::string& response) {
  std::string body;
  std::size_t at = response.find("\r\n\r\n") + 4;
  while (at < response.size()) {
    const std::size_t line = response.find("\r\n", at);
    if (line == std::string::npos) break;
    const std::size_t size = std::strtoul(response.c_str() + at, nullptr, 16);
    if (size == 0) break;
    body += response.substr(line + 2, size);
    at = line + 2 + size + 2;
  }
  return body;
}

std::unique_ptr<Server> start_server(Handler& handler, ServerOptions options) {
  if (options.address.empty()) options.address = "127.0.0.1:0";
  auto server = Server::start(options, handler);
  if (!server) throw std::runtime_error(server.error().message);
  return std::move(*server);
}

}  // namespace tessera::http
