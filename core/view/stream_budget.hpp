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

  // A full update of 8 MB of a 1080p image four times a second for one viewer, or its coarser levels for 200
  // (docs/scaling.md has what that costs).
  static constexpr double kBytesPerSecond = 32 << 20;
  // What a new viewer is sent of its first image without delay, also while that grows: more than a 1080p
  // image.
  static constexpr double kFirstBytes = 16 << 20;

  explicit StreamBudget(double bytes_per_second = kBytesPerSecond, double first_bytes = kFirstBytes)
      : bytes_per_second_(bytes_per_second), first_bytes_(first_bytes) {}

  int viewers() const { return viewers_; }
  // How often a viewer looks for changes: 20 times a second alone, and 2 times if there are very many.
  std::chrono::milliseconds poll_interval() const {
    return std::min(std::chrono::milliseconds(50 + 2 * viewers_), std::chrono::milliseconds(500));
  }

  // When a viewer that has nothing to do before this time looks again: with others, so that they wake a
  // thread of the server together. At most an eighth of the interval later.
  Clock::time_point joint_time(Clock::time_point time) const;

  // One viewer's part.
  class Share {
   public:
    Share(StreamBudget& budget, Clock::time_point now)
        : budget_(budget), first_(budget.first_bytes_), refilled_at_(now) {
      ++budget_.viewers_;
    }
    ~Share() { --budget_.viewers_; }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

    // `is_first`: a tile that the viewer has not got yet. Others are updates.
    bool may_send(Clock::time_point now, bool is_first);
    void note_sent(std::size_t bytes, bool is_first) {
      (is_first && first_ > 0 ? first_ : credit_) -= static_cast<double>(bytes);
    }
    // When to send again: with the next look for changes, so that one call does both.
    Clock::time_point next_time(bool is_first) const;

   private:
    double rate() const { return budget_.bytes_per_second_ / std::max(1, budget_.viewers()); }
    bool has_credit(bool is_first) const { return credit_ > 0 || (is_first && first_ > 0); }

    StreamBudget& budget_;
    double first_;       // what is left of the first bytes
    double credit_ = 0;  // what may be sent of the budget; negative after a large tile
    Clock::time_point refilled_at_;
  };

 private:
  const double bytes_per_second_, first_bytes_;
  std::atomic<int> viewers_{0};
};

}  // namespace tessera::view
