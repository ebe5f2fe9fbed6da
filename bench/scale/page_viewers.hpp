// SPDX-License-Identifier: Apache-2.0
// Browsers that watch the image of one job over connections of their own (GET /api/v1/jobs/ID/tiles). They
// read everything at once. The first one also looks at the frames, and measures how late tiles come.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/region.hpp"

namespace tessera::bench {

class PageViewers {
 public:
  using Clock = std::chrono::steady_clock;

  PageViewers() = default;
  // Ends all connections.
  ~PageViewers();

  // Adds viewers, which begin to watch. `address`: HOST:PORT of the page.
  core::Status start(int count, const std::string& address, const std::string& job_id);

  // Samples of this tile were counted: the answer to their result was received. Any thread.
  void counted(const core::PixelRect& rect);

  // What all of them have received.
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t tiles() const { return tiles_; }  // those of the first one
  int ended() const { return ended_; }
  // When the first one had received its first tile.
  std::optional<Clock::time_point> first_tile() const;
  // The times from counted() to the tile in the first one, since the last call of this function.
  std::vector<double> take_delays();

 private:
  void run(std::stop_token stop);
  void take(std::string_view bytes);
  void take_frames();
  void take_tile(const std::string& header);

  int epoll_ = -1;
  int first_ = -1;  // the socket of the first one
  std::vector<int> sockets_;
  std::atomic<std::uint64_t> bytes_{0}, tiles_{0};
  std::atomic<int> ended_{0};
  // Of the thread that reads:
  std::string received_, frames_;
  bool has_head_ = false;

  mutable std::mutex mutex_;
  // Guarded by mutex_: the first count of each tile that was not shown since, by its top left pixel.
  std::map<std::pair<int, int>, Clock::time_point> waiting_;
  std::vector<double> delays_;
  std::optional<Clock::time_point> first_tile_;

  std::jthread thread_;
};

}  // namespace tessera::bench
