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
#include <utility>

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
  for (const auto& [host, port] : ports_) close(port->socket);
}

void Network::Switch::add_port(int host, const std::string& interface) {
  auto port = std::make_shared<Port>();
  port->socket = open_port(interface);
  const std::lock_guard lock(mutex_);
  ports_[host] = std::move(port);
}

std::shared_ptr<Network::Switch::Port> Network::Switch::port_of(int host) const {
  const std::lock_guard lock(mutex_);
  return ports_.at(host);
}

void Network::Switch::set_line(int host, std::chrono::milliseconds delay, double bytes_per_second) {
  const auto port = port_of(host);
  port->delay_ms = delay.count();
  port->up.bytes_per_second = port->down.bytes_per_second = bytes_per_second;
}

std::uint64_t Network::Switch::sent_bytes(int host) const {
  return port_of(host)->sent_bytes;
}

void Network::Switch::run() {
  while (!stopping_) {
    Ports ports;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& [host, port] : ports_) ports.push_back(port);
    }
    std::vector<pollfd> waiting;
    for (const auto& port : ports) waiting.push_back({port->socket, POLLIN, 0});
    int wait_ms = kLongestPollMs;
    if (!held_up_.empty()) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(held_up_.begin()->first - Clock::now());
      wait_ms = static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, kLongestPollMs));
    }
    poll(waiting.data(), waiting.size(), wait_ms);
    take_frames(ports);
    pass_on(ports);
  }
}

std::optional<Network::Switch::Clock::time_point> Network::Switch::pass(Line& line, std::size_t bytes,
                                                                        Clock::time_point time) {
  const double rate = line.bytes_per_second;
  if (!(rate > 0)) return time;
  if (line.is_free > time + kMaxQueue) return std::nullopt;
  const std::chrono::duration<double> takes(static_cast<double>(bytes) / rate);
  line.is_free = std::max(line.is_free, time) + std::chrono::duration_cast<Clock::duration>(takes);
  return line.is_free;
}

std::optional<Network::Switch::Clock::time_point> Network::Switch::passes_at(const Frame& frame) {
  const std::size_t bytes = frame.bytes.size();
  auto time = pass(frame.from->up, bytes, Clock::now());
  if (time) time = pass(site_, bytes, *time);
  if (time && frame.to) time = pass(frame.to->down, bytes, *time);
  if (!time) return time;
  const std::int64_t delay_ms = delay_ms_ + frame.from->delay_ms + (frame.to ? frame.to->delay_ms.load() : 0);
  return *time + std::chrono::milliseconds(delay_ms);
}

void Network::Switch::take_frames(const Ports& ports) {
  std::string buffer(kMaxFrameBytes, '\0');
  for (const auto& port : ports) {
    while (true) {
      const ssize_t size = recv(port->socket, buffer.data(), buffer.size(), 0);
      if (size <= 0) break;  // no more frames, or the cable is disconnected
      take_frame(port, buffer.substr(0, static_cast<std::size_t>(size)));
    }
  }
}

void Network::Switch::take_frame(const std::shared_ptr<Port>& from, std::string bytes) {
  if (bytes.size() < sizeof(ethhdr)) return;
  from->sent_bytes += bytes.size();
  if (std::uniform_real_distribution<double>()(random_) < lost_share_) return;
  // A frame begins with its destination and its source.
  Station destination, source;
  std::copy_n(bytes.begin(), destination.size(), destination.begin());
  std::copy_n(bytes.begin() + destination.size(), source.size(), source.begin());
  stations_[source] = from;
  const auto known = stations_.find(destination);
  Frame frame{from, known == stations_.end() ? nullptr : known->second, std::move(bytes)};
  if (const auto due = passes_at(frame)) held_up_.emplace(*due, std::move(frame));
}

void Network::Switch::pass_on(const Ports& ports) {
  while (!held_up_.empty() && held_up_.begin()->first <= Clock::now()) {
    const Frame& frame = held_up_.begin()->second;
    // Frames to a disconnected cable are lost.
    const auto send_to = [&](const Port& port) {
      [[maybe_unused]] const ssize_t sent = send(port.socket, frame.bytes.data(), frame.bytes.size(), 0);
    };
    if (frame.to) send_to(*frame.to);
    for (const auto& port : ports)
      if (!frame.to && port != frame.from) send_to(*port);
    held_up_.erase(held_up_.begin());
  }
}

}  // namespace tessera::test
