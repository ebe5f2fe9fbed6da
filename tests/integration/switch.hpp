// SPDX-License-Identifier: Apache-2.0
// A switch between network interfaces of this namespace, run by its own thread. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
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

  // Forwards frames from each interface to all others.
  void add_port(const std::string& interface);
  void hold_up(std::chrono::milliseconds delay) { delay_ms_ = delay.count(); }
  void lose(double share) { lost_share_ = share; }
  void limit_rate(double bytes_per_second) { bytes_per_second_ = bytes_per_second; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame {
    Clock::time_point due;
    int from;
    std::string bytes;
  };

  void run();
  // When a frame that arrives now is forwarded. Empty if it is dropped because the queue is full.
  std::optional<Clock::time_point> passes_at(std::size_t bytes);
  void take_frames(const std::vector<int>& ports);
  void pass_on(const std::vector<int>& ports);

  std::atomic<std::int64_t> delay_ms_ = 0;
  std::atomic<double> lost_share_ = 0;
  std::atomic<double> bytes_per_second_ = 0;  // 0: unlimited
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;
  std::vector<int> ports_;  // sockets; guarded by mutex_
  // Used by the thread only:
  std::deque<Frame> held_up_;
  Clock::time_point line_is_free_{};
  std::mt19937 random_{1};
  std::thread thread_;
};

}  // namespace tessera::test
