// SPDX-License-Identifier: Apache-2.0
// The environment of a simulated farm: virtual time, random numbers, a network, and the first violation.
// Everything follows from one seed.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <queue>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::simulation {

using scheduler::Duration;
using scheduler::Time;

inline Duration seconds(double count) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(count));
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  // Uniform in [low, high].
  int integer(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  bool chance(double probability) { return real(0, 1) < probability; }

 private:
  std::mt19937_64 engine_;
};

class World {
 public:
  World(std::uint64_t seed, bool verbose) : random(seed), verbose_(verbose) {}

  Random random;

  Time now() const { return now_; }
  void after(Duration delay, std::function<void()> what) {
    queue_.push({now_ + std::max(delay, Duration::zero()), ++sequence_, std::move(what)});
  }

  // Sends a message: it may be delayed, lost, duplicated or reordered.
  void send(const std::function<void()>& deliver) {
    if (random.chance(loss_)) return;
    const int copies = random.chance(duplication_) ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      after(seconds(random.chance(0.02) ? random.real(0, longest_delay_) : random.real(0.001, 0.02)),
            deliver);
    }
  }
  void make_network(double loss, double duplication, double longest_delay_seconds) {
    loss_ = loss, duplication_ = duplication, longest_delay_ = longest_delay_seconds;
  }

  // Runs the next event. False if there is none, or after a violation.
  bool step() {
    if (queue_.empty() || failure_) return false;
    const Due due = queue_.top();
    queue_.pop();
    now_ = due.time;
    due.what();
    return !failure_;
  }

  // Keeps the first violation.
  void fail(const std::string& what) {
    if (!failure_) failure_ = fmt::format("at {:.3f} s: {}", seconds_since_start(), what);
    note(what);
  }
  const std::optional<std::string>& failure() const { return failure_; }

  void note(const std::string& what) const {
    if (verbose_) fmt::print("{:9.3f}  {}\n", seconds_since_start(), what);
  }

 private:
  struct Due {
    Time time;
    std::uint64_t sequence;
    std::function<void()> what;
    bool operator<(const Due& other) const {
      return std::pair(time, sequence) > std::pair(other.time, other.sequence);
    }
  };

  double seconds_since_start() const {
    return std::chrono::duration<double>(now_.time_since_epoch()).count();
  }

  Time now_{};
  std::uint64_t sequence_ = 0;
  std::priority_queue<Due> queue_;
  std::optional<std::string> failure_;
  double loss_ = 0, duplication_ = 0, longest_delay_ = 0;
  bool verbose_;
};

}  // namespace tessera::simulation
