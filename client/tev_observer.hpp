// SPDX-License-Identifier: Apache-2.0
// Shows a local render in tev. A thread of its own sends tiles as fast as tev takes them: a slow tev gets
// fewer updates, and the render does not wait for it. A tev that is started late, or again, gets all tiles.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/notices.hpp"
#include "client/render_observer.hpp"
#include "client/tev_connection.hpp"
#include "client/tev_packets.hpp"

namespace tessera::client {

class TevObserver : public RenderObserver {
 public:
  // `image` is the name in tev, which shows layers as channels. A missing or lost tev becomes a notice.
  // `notices` must outlive the observer.
  TevObserver(std::string address, std::string image, Notices& notices);

  void begin(const core::Film& film, const core::RenderSettings& settings) override;
  std::mutex& film_mutex() override { return film_mutex_; }
  void samples_added(const core::PixelRect& rect, const core::SampleRange& range) override;
  // Sends what tev has not yet got, if it is there.
  void end() override;

 private:
  void run();
  bool connect();
  void disconnect(const core::Error& why);
  bool wait_for_work();
  bool rest(double seconds);
  std::vector<int> take_changed();
  void mark_all();
  core::Status send_tile(int tile);

  const std::string address_;
  TevImage image_;
  Notices& notices_;
  const core::Film* film_ = nullptr;
  std::mutex film_mutex_;
  std::optional<TevConnection> tev_;  // of the thread

  std::mutex mutex_;
  std::condition_variable news_;
  // Guarded by mutex_.
  std::vector<bool> changed_;  // tiles that tev lacks
  bool has_changes_ = false, has_ended_ = false;

  std::thread thread_;
};

}  // namespace tessera::client
