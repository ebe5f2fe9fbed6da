// Renders what is held, piece by piece. The only thread that computes: everything parallel happens inside of
// it.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>

#include "worker/holdings.hpp"
#include "worker/pace.hpp"
#include "worker/scene_cache.hpp"

namespace tessera::worker {

class RenderLoop {
 public:
  RenderLoop(int threads, Holdings& holdings, std::optional<core::SceneStore> store = {});

  // Returns after a stop, at the end of the piece in hand. A job whose scene cannot be built is logged, and
  // its leases are given back.
  void run(const std::stop_token& stop);
  // Pixel samples rendered so far, wanted by others or not. For the thread that runs it.
  std::uint64_t samples() const { return samples_; }

 private:
  void render(const Piece& piece);

  const int threads_;
  Holdings& holdings_;
  SceneCache scenes_;
  Pace pace_;
  std::uint64_t samples_ = 0;
};

}  // namespace tessera::worker
