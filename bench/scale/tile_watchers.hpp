// SPDX-License-Identifier: Apache-2.0
// Clients that watch the tiles of one job (WatchTiles) over connections of their own.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <grpcpp/channel.h>

#include "core/base/error.hpp"

namespace tessera::bench {

class TileWatchers {
 public:
  using Connect = std::function<core::Result<std::shared_ptr<grpc::Channel>>()>;

  TileWatchers();
  // Ends all calls.
  ~TileWatchers();

  core::Status start(int count, const std::string& job_id, const Connect& connect);

  // What all of them have received.
  std::uint64_t tiles() const { return tiles_; }
  std::uint64_t bytes() const { return bytes_; }
  // Those whose calls have ended.
  int ended() const { return ended_; }

 private:
  class Watch;

  std::atomic<std::uint64_t> tiles_{0}, bytes_{0};
  std::atomic<int> ended_{0};
  std::vector<std::unique_ptr<Watch>> watches_;
};

}  // namespace tessera::bench
