// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/switch.hpp"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace tessera::test {

namespace {

constexpr int kLongestPollMs = 20;
constexpr std::size_t kMaxFrameBytes = 1 << 16;
constexpr int kBufferBytes = 8 << 20;
// The queue of a slow line, as in a router.
constexpr std::chrono::seconds kMaxQueue{1};

int open_port(const std::string& interface) {
  const int port = socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, htons(ETH_P_ALL));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  const int yes = 1;
  if (port < 0 || bind(port, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      setsockopt(port, SOL_PACKET, PACKET_IGNORE_OUTGOING, &yes, sizeof(yes)) != 0)
    throw NoNetwork("no raw packets here (AF_PACKET): " + std::string(std::strerror(errno)));
  setsockopt(port, SOL_SOCKET, SO_RCVBUF, &kBufferBytes, sizeof(kBufferBytes));
  return port;
}

}  // namespace

Network::Switch::Switch() : thread_([this] { run(); }) {}

Network::Switch::~Switch() {
  stopping_ = true;
  thread_.join();
  for (const int port : ports_) close(port);
}

void Network::Switch::add_port(const std::string& interface) {
  const int port = open_port(interface);
  const std::lock_guard lock(mutex_);
  ports_.push_back(port);
}

void Network::Switch::run() {
  while (!stopping_) {
    std::vector<int> ports;
    {
      const std::lock_guard lock(mutex_);
      ports = ports_;
    }
    std::vector<pollfd> waiting;
    for (const int port : ports) waiting.push_back({port, POLLIN, 0});
    int wait_ms = kLongestPollMs;
    if (!held_up_.empty()) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(held_up_.front().due - Clock::now());
      wait_ms = static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, kLongestPollMs));
    }
    poll(waiting.data(), waiting.size(), wait_ms);
    take_frames(ports);
    pass_on(ports);
  }
}

// All frames share one line, as at one site.
std::optional<Network::Switch::Clock::time_point> Network::Switch::passes_at(std::size_t bytes) {
  const auto now = Clock::now();
  const auto delay = std::chrono::milliseconds(delay_ms_);
  if (!(bytes_per_second_ > 0)) return now + delay;
  if (line_is_free_ > now + kMaxQueue) return std::nullopt;
  const std::chrono::duration<double> takes(static_cast<double>(bytes) / bytes_per_second_);
  line_is_free_ = std::max(line_is_free_, now) + std::chrono::duration_cast<Clock::duration>(takes);
  return line_is_free_ + delay;
}

void Network::Switch::take_frames(const std::vector<int>& ports) {
  std::string buffer(kMaxFrameBytes, '\0');
  for (const int port : ports) {
    while (true) {
      const ssize_t size = recv(port, buffer.data(), buffer.size(), 0);
      if (size <= 0) break;  // no more frames, or the cable is disconnected
      if (std::uniform_real_distribution<double>()(random_) < lost_share_) continue;
      const auto due = passes_at(static_cast<std::size_t>(size));
      if (!due) continue;
      held_up_.push_back({*due, port, buffer.substr(0, static_cast<std::size_t>(size))});
    }
  }
}

void Network::Switch::pass_on(const std::vector<int>& ports) {
  while (!held_up_.empty() && held_up_.front().due <= Clock::now()) {
    const Frame& frame = held_up_.front();
    for (const int port : ports) {
      // Frames to a disconnected cable are lost.
      if (port != frame.from) [[maybe_unused]]
        const ssize_t sent = send(port, frame.bytes.data(), frame.bytes.size(), 0);
    }
    held_up_.pop_front();
  }
}

}  // namespace tessera::test
