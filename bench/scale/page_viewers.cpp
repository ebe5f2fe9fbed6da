// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/page_viewers.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>

namespace tessera::bench {

namespace {

constexpr int kWaitMs = 50;
constexpr std::size_t kFrameHead = 8;

// -1 if it cannot be reached. `address` is an IPv4 address with a port.
int connect_to(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  sockaddr_in peer{};
  peer.sin_family = AF_INET;
  peer.sin_port = htons(static_cast<std::uint16_t>(std::atoi(address.c_str() + colon + 1)));
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (inet_pton(AF_INET, address.substr(0, colon).c_str(), &peer.sin_addr) == 1 &&
      ::connect(socket, reinterpret_cast<const sockaddr*>(&peer), sizeof peer) == 0)
    return socket;
  ::close(socket);
  return -1;
}

std::uint32_t length_at(const std::string& bytes, std::size_t at) {
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + at, sizeof length);
  return length;
}

// The number after "KEY": in a flat JSON object; 0 if there is none.
int number_in(const std::string& json, const std::string& key) {
  const std::size_t at = json.find('"' + key + "\":");
  return at == std::string::npos ? 0 : std::atoi(json.c_str() + at + key.size() + 3);
}

}  // namespace

PageViewers::~PageViewers() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  for (const int socket : sockets_) ::close(socket);
  if (epoll_ >= 0) ::close(epoll_);
}

core::Status PageViewers::start(int count, const std::string& address, const std::string& job_id) {
  if (epoll_ < 0) epoll_ = ::epoll_create1(EPOLL_CLOEXEC);
  const std::string request =
      fmt::format("GET /api/v1/jobs/{}/tiles HTTP/1.1\r\nHost: {}\r\n\r\n", job_id, address);
  for (int i = 0; i < count; ++i) {
    const int socket = connect_to(address);
    if (socket < 0 || ::send(socket, request.data(), request.size(), MSG_NOSIGNAL) < 0)
      return core::fail(core::ErrorCode::kUnavailable, "cannot reach the page at " + address);
    if (sockets_.empty()) first_ = socket;
    sockets_.push_back(socket);
    epoll_event event{.events = EPOLLIN, .data = {.fd = socket}};
    ::epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &event);
  }
  if (!thread_.joinable()) thread_ = std::jthread([this](std::stop_token stop) { run(std::move(stop)); });
  return {};
}

void PageViewers::run(std::stop_token stop) {
  std::array<epoll_event, 64> ready{};
  std::string buffer(1 << 20, '\0');
  while (!stop.stop_requested()) {
    const int count = ::epoll_wait(epoll_, ready.data(), static_cast<int>(ready.size()), kWaitMs);
    for (int i = 0; i < count; ++i) {
      const int socket = ready[static_cast<std::size_t>(i)].data.fd;
      const ssize_t received = ::recv(socket, buffer.data(), buffer.size(), MSG_DONTWAIT);
      if (received > 0) {
        bytes_ += static_cast<std::uint64_t>(received);
        if (socket == first_) take({buffer.data(), static_cast<std::size_t>(received)});
      } else {
        ::epoll_ctl(epoll_, EPOLL_CTL_DEL, socket, nullptr);
        ++ended_;
      }
    }
  }
}

// Removes the head of the response and its chunks.
void PageViewers::take(std::string_view bytes) {
  received_ += bytes;
  if (!has_head_) {
    const std::size_t end = received_.find("\r\n\r\n");
    if (end == std::string::npos) return;
    received_.erase(0, end + 4);
    has_head_ = true;
  }
  for (std::size_t line = received_.find("\r\n"); line != std::string::npos; line = received_.find("\r\n")) {
    const auto size = static_cast<std::size_t>(std::strtoul(received_.c_str(), nullptr, 16));
    if (received_.size() < line + 2 + size + 2) break;
    frames_.append(received_, line + 2, size);
    received_.erase(0, line + 2 + size + 2);
  }
  take_frames();
}

void PageViewers::take_frames() {
  std::size_t at = 0;
  while (frames_.size() >= at + kFrameHead) {
    const std::size_t header = length_at(frames_, at), payload = length_at(frames_, at + 4);
    if (frames_.size() < at + kFrameHead + header + payload) break;
    if (payload > 0) take_tile(frames_.substr(at + kFrameHead, header));
    at += kFrameHead + header + payload;
  }
  frames_.erase(0, at);
}

void PageViewers::take_tile(const std::string& header) {
  ++tiles_;
  const std::lock_guard lock(mutex_);
  if (!first_tile_) first_tile_ = Clock::now();
  const auto counted = waiting_.find({number_in(header, "x0"), number_in(header, "y0")});
  if (counted == waiting_.end()) return;
  delays_.push_back(std::chrono::duration<double>(Clock::now() - counted->second).count());
  waiting_.erase(counted);
}

void PageViewers::counted(const core::PixelRect& rect) {
  const std::lock_guard lock(mutex_);
  waiting_.try_emplace({rect.x0, rect.y0}, Clock::now());
}

std::optional<PageViewers::Clock::time_point> PageViewers::first_tile() const {
  const std::lock_guard lock(mutex_);
  return first_tile_;
}

std::vector<double> PageViewers::take_delays() {
  const std::lock_guard lock(mutex_);
  return std::exchange(delays_, {});
}

}  // namespace tessera::bench
