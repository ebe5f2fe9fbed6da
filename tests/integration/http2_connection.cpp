// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/http2_connection.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace tessera::test {
namespace {

constexpr std::size_t kFrameHeaderBytes = 9;
enum FrameType : std::uint8_t { kData = 0, kHeaders = 1, kResetStream = 3, kSettings = 4 };
constexpr std::uint8_t kEndStream = 1, kEndHeaders = 4, kAck = 1;
constexpr std::uint16_t kMaxConcurrentStreams = 3, kInitialWindowSize = 4;

std::string big_endian(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text.push_back(static_cast<char>(value >> (8 * i)));
  return text;
}

std::uint32_t number(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

std::string frame(FrameType type, std::uint8_t flags, std::uint32_t stream, const std::string& payload) {
  return big_endian(static_cast<std::uint32_t>(payload.size()), 3) + static_cast<char>(type) +
         static_cast<char>(flags) + big_endian(stream, 4) + payload;
}

// RFC 7541, 6.2.2: a literal header field without indexing, with a new name.
std::string header(const std::string& name, const std::string& value) {
  return std::string(1, '\0') + static_cast<char>(name.size()) + name + static_cast<char>(value.size()) +
         value;
}

std::string headers(const std::string& path) {
  return header(":method", "POST") + header(":scheme", "http") + header(":path", path) +
         header(":authority", "localhost") + header("content-type", "application/grpc") +
         header("te", "trailers");
}

// A failed connection shows with the first call.
int connect_to(const std::string& address) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in peer{};
  peer.sin_family = AF_INET;
  peer.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  peer.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
  static_cast<void>(::connect(socket, reinterpret_cast<const sockaddr*>(&peer), sizeof peer));
  return socket;
}

}  // namespace

Http2Connection::Http2Connection(const std::string& address, std::uint32_t stream_window_bytes)
    : socket_(connect_to(address)) {
  send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" +
       frame(kSettings, 0, 0, big_endian(kInitialWindowSize, 2) + big_endian(stream_window_bytes, 4)));
}

Http2Connection::~Http2Connection() {
  ::close(socket_);
}

bool Http2Connection::call(const std::string& method, const std::string* message) {
  const std::uint32_t stream = next_stream_;
  next_stream_ += 2;
  std::string bytes = frame(kHeaders, kEndHeaders, stream, headers(method));
  if (message != nullptr)
    bytes +=
        frame(kData, kEndStream, stream,
              std::string(1, '\0') + big_endian(static_cast<std::uint32_t>(message->size()), 4) + *message);
  return send(bytes);
}

bool Http2Connection::send(const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t now = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (now <= 0) return false;
    sent += static_cast<std::size_t>(now);
  }
  return true;
}

void Http2Connection::drain(int milliseconds) {
  std::array<char, 1 << 16> buffer;
  pollfd waiting{socket_, POLLIN, 0};
  while (::poll(&waiting, 1, milliseconds) == 1) {
    const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (count <= 0) return;
    received_.append(buffer.data(), static_cast<std::size_t>(count));
    take_frames();
  }
}

void Http2Connection::take_frames() {
  std::size_t at = 0;
  while (received_.size() - at >= kFrameHeaderBytes) {
    const std::size_t length = number(received_, at, 3);
    if (received_.size() - at < kFrameHeaderBytes + length) break;
    const auto type = static_cast<std::uint8_t>(received_[at + 3]);
    const auto flags = static_cast<std::uint8_t>(received_[at + 4]);
    if (type == kResetStream || (type == kHeaders && (flags & kEndStream) != 0))
      ended_streams_.insert(number(received_, at + 5, 4));
    if (type == kSettings && (flags & kAck) == 0)
      take_settings(received_.substr(at + kFrameHeaderBytes, length));
    at += kFrameHeaderBytes + length;
  }
  received_.erase(0, at);
}

void Http2Connection::take_settings(const std::string& payload) {
  for (std::size_t at = 0; at + 6 <= payload.size(); at += 6)
    if (number(payload, at, 2) == kMaxConcurrentStreams) max_concurrent_streams_ = number(payload, at + 2, 4);
  send(frame(kSettings, kAck, 0, ""));
}

}  // namespace tessera::test
