// SPDX-License-Identifier: Apache-2.0
// The image of a job as a stream of frames for the page; docs/http-api.md describes them. A viewer that is
// slow, and one of many, gets fewer updates of each tile, and always the newest one.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/http/server.hpp"
#include "core/view/encoded_tiles.hpp"
#include "core/view/stream_budget.hpp"
#include "core/view/stream_query.hpp"
#include "core/view/tile_frames.hpp"
#include "core/view/tile_queue.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::view {

// What all streams of a server share. Thread-safe, if the clock is.
struct StreamSettings {
  EncodedTiles& tiles;
  StreamBudget& budget;
  std::function<std::chrono::steady_clock::time_point()> now = std::chrono::steady_clock::now;
};

class TileStream final : public http::BodySource {
 public:
  // `settings` must outlive the stream. The image must have the layer that is asked for.
  TileStream(std::shared_ptr<TileSource> source, const StreamQuery& query, const StreamSettings& settings);

  State read(std::string& out, std::size_t max_bytes) override;
  std::chrono::milliseconds longest_wait() const override { return wait_; }

 private:
  using Clock = std::chrono::steady_clock;

  // Each of these returns false if the stream must end.
  bool poll(Clock::time_point now, std::string& out);
  bool poll_header(Clock::time_point now, std::string& out);
  bool poll_changes();
  bool write_tiles(std::string& out, std::size_t max_bytes, Clock::time_point now);
  bool write_tile(const TileQueue::Next& next, JoinedTiles& joined, std::string& out, Clock::time_point now);

  void find_grid();
  bool is_wanted(int tile) const;
  // Whether the next tile belongs to the first image of a viewer, who else has earlier tiles.
  bool is_next_first() const { return query_.since == 0 && queue_->is_next_new(); }
  void write_revision(std::string& out, Clock::time_point now);
  // Of those that read() waits for.
  std::chrono::milliseconds time_until_next(Clock::time_point now) const;

  const std::shared_ptr<TileSource> source_;
  const StreamQuery query_;
  const StreamSettings& settings_;
  StreamBudget::Share share_;

  std::optional<core::TileGrid> grid_;
  std::optional<TileQueue> queue_;  // once there is a grid
  bool is_first_poll_ = true;       // with a grid
  bool is_over_ = false;
  Revision seen_;      // the last change that is in the queue
  Revision reported_;  // what the viewer knows that it has
  bool reported_whole_ = false;
  Revision header_ = 0;
  bool has_header_ = false;
  Clock::time_point next_poll_{}, next_header_{}, next_revision_{}, last_written_{}, retry_at_{};
  std::chrono::milliseconds wait_{0};
};

}  // namespace tessera::view
