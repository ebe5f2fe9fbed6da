// SPDX-License-Identifier: Apache-2.0
// How much all viewers together are sent: a constant number of bytes each second, divided among them, so that
// many viewers cost about what a few do. Each one's first image comes at full speed. Thread-safe; a Share is
// for one thread at a time.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>

namespace tessera::view {

class StreamBudget {
 public:
  using Clock = std::chrono::steady_clock;

  // About two percent of a core: a full update of 8 MB of a 1080p image twice a second for one viewer, or its
  // coarser levels for 200.
  static constexpr double kBytesPerSecond = 16 << 20;
  // What a new viewer is sent without delay: more than a 1080p image.
  static constexpr double kFirstBytes = 16 << 20;

  explicit StreamBudget(double bytes_per_second = kBytesPerSecond, double first_bytes = kFirstBytes)
      : bytes_per_second_(bytes_per_second), first_bytes_(first_bytes) {}

  int viewers() const { return viewers_; }
  // How often a viewer looks for changes: 20 times a second alone, and 2 times if there are very many.
  std::chrono::milliseconds poll_interval() const {
    return std::min(std::chrono::milliseconds(50 + 2 * viewers_), std::chrono::milliseconds(500));
  }

  // One viewer's part.
  class Share {
   public:
    Share(StreamBudget& budget, Clock::time_point now)
        : budget_(budget), credit_(budget.first_bytes_), refilled_at_(now) {
      ++budget_.viewers_;
    }
    ~Share() { --budget_.viewers_; }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

    bool may_send(Clock::time_point now);
    void note_sent(std::size_t bytes) { credit_ -= static_cast<double>(bytes); }
    // When to send again: late enough that it is worth a call.
    Clock::time_point next_time() const;

   private:
    double rate() const { return budget_.bytes_per_second_ / std::max(1, budget_.viewers()); }

    StreamBudget& budget_;
    double credit_;
    Clock::time_point refilled_at_;
  };

 private:
  const double bytes_per_second_, first_bytes_;
  std::atomic<int> viewers_{0};
};

}  // namespace tessera::view
