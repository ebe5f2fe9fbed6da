// SPDX-License-Identifier: Apache-2.0
// Renders the held leases piece by piece. It is the only thread that computes; rendering itself is parallel.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>

#include "core/integrators/render.hpp"
#include "worker/lease_tracker.hpp"
#include "worker/metrics.hpp"
#include "worker/pace.hpp"
#include "worker/scene_cache.hpp"

namespace tessera::worker {

class RenderLoop {
 public:
  // The signature of core::integrators::render.
  using Render = std::function<core::FilmTile(const core::integrators::RenderPlan&, core::PixelRect,
                                              core::SampleRange, int threads)>;

  RenderLoop(int threads, LeaseTracker& lease_tracker, Metrics& metrics, LoadScene load,
             std::optional<core::SceneStore> store = {}, Render render = core::integrators::render);

  // Returns after a stop, at the end of the current piece, or at once while a scene is loaded. A job whose
  // scene cannot be loaded or built is logged, and its leases are given back.
  void run(const std::stop_token& stop);

 private:
  void render(const Piece& piece, const std::stop_token& stop);
  // Fails if memory does not suffice. Throws std::bad_alloc.
  core::Status try_to_render(const Piece& piece, const std::stop_token& stop);
  void give_back(const Piece& piece, const core::Error& why);
  void decline(const Piece& piece, const std::string& why);

  const int threads_;
  const Render render_;
  LeaseTracker& lease_tracker_;
  Metrics& metrics_;
  SceneCache scenes_;
  Pace pace_;
};

}  // namespace tessera::worker
