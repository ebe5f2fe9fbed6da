// SPDX-License-Identifier: Apache-2.0
// A worker: the threads that synchronise, fetch, render and deliver, and their shutdown, also when a piece
// never ends.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "proto/retry.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/blob_cache.hpp"
#include "worker/confined_loader.hpp"
#include "worker/hang_watchdog.hpp"
#include "worker/metrics.hpp"
#include "worker/peer_server.hpp"
#include "worker/render_loop.hpp"
#include "worker/sync_loop.hpp"

namespace tessera::worker {

class Worker {
 public:
  struct Options {
    // How long a stopping worker tries to deliver its results.
    proto::Duration drain_deadline = std::chrono::seconds(20);
    // Explains a failed call.
    SyncLoop::Explain explain = [](const grpc::Status& status) { return proto::error_from_grpc(status); };
    LoadScene load_scene = [](const SceneFiles& files, int threads, const std::stop_token& stop) {
      return load_confined({}, files, threads, stop);
    };
    RenderLoop::Render render = core::integrators::render;
    // How long an unwanted piece may be rendered before it is presumed endless.
    LeaseTracker::HangTimeout hang_timeout = [](const UnwantedPiece& piece) {
      return compute_hang_timeout(piece, 0);
    };
    // Replaces this process, since threads in an endless piece cannot be ended. Called after everything else
    // is delivered. If it returns, the worker waits for the piece. `must_end`: the coordinator told the
    // worker to stop, so the process must not start again.
    std::function<void(const UnwantedPiece&, bool must_end)> self_restart = [](const UnwantedPiece&, bool) {};
    // What serves other workers; null: nothing does. It must outlive the worker.
    const PeerServer* peer_server = nullptr;
  };

  // All three must outlive the worker.
  Worker(Identity identity, const BlobCache& cache, v1::WorkerService::StubInterface& coordinator)
      : Worker(std::move(identity), cache, coordinator, Options{}) {}
  Worker(Identity identity, const BlobCache& cache, v1::WorkerService::StubInterface& coordinator,
         Options options);

  // Works until a stop is requested, also by the coordinator. Then finishes the current piece (unless it is
  // presumed endless), delivers all results, deregisters and returns.
  void run(const std::stop_token& stop);

  const Metrics& metrics() const { return metrics_; }

 private:
  const Identity identity_;
  const BlobCache& cache_;
  v1::WorkerService::StubInterface& coordinator_;
  const Options options_;
  Metrics metrics_;
};

}  // namespace tessera::worker
