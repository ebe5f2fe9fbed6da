// SPDX-License-Identifier: Apache-2.0
// A switch between network interfaces of this namespace, run by its own thread. It learns at which port each
// station is. Thread-safe.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/integration/network.hpp"

namespace tessera::test {

class Network::Switch {
 public:
  Switch();
  ~Switch();

  void add_port(int host, const std::string& interface);
  void hold_up(std::chrono::milliseconds delay) { delay_ms_ = delay.count(); }
  void lose(double share) { lost_share_ = share; }
  void limit_rate(double bytes_per_second) { site_.bytes_per_second = bytes_per_second; }
  void set_line(int host, std::chrono::milliseconds delay, double bytes_per_second);
  std::uint64_t sent_bytes(int host) const;

 private:
  using Clock = std::chrono::steady_clock;
  using Station = std::array<char, 6>;  // an Ethernet address
  // One direction of a line.
  struct Line {
    std::atomic<double> bytes_per_second = 0;  // 0: unlimited
    Clock::time_point is_free{};               // used by the thread only
  };
  struct Port {
    int socket;
    std::atomic<std::int64_t> delay_ms = 0;
    Line up, down;
    std::atomic<std::uint64_t> sent_bytes = 0;
  };
  using Ports = std::vector<std::shared_ptr<Port>>;
  struct Frame {
    std::shared_ptr<Port> from, to;  // `to` is null for all others
    std::string bytes;
  };

  void run();
  // When a frame that enters the line at `time` has passed it. Empty if it is dropped because the queue is
  // full.
  static std::optional<Clock::time_point> pass(Line& line, std::size_t bytes, Clock::time_point time);
  std::optional<Clock::time_point> passes_at(const Frame& frame);
  void take_frames(const Ports& ports);
  void take_frame(const std::shared_ptr<Port>& from, std::string bytes);
  void pass_on(const Ports& ports);
  std::shared_ptr<Port> port_of(int host) const;

  std::atomic<std::int64_t> delay_ms_ = 0;
  std::atomic<double> lost_share_ = 0;
  std::atomic<bool> stopping_ = false;
  mutable std::mutex mutex_;
  std::map<int, std::shared_ptr<Port>> ports_;  // by host; guarded by mutex_
  // Used by the thread only:
  Line site_;  // all frames share it
  std::map<Station, std::shared_ptr<Port>> stations_;
  std::multimap<Clock::time_point, Frame> held_up_;  // by when they are due
  std::mt19937 random_{1};
  std::thread thread_;
};

}  // namespace tessera::test
