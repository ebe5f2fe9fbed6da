// SPDX-License-Identifier: Apache-2.0
// A worker: the threads that synchronise, fetch, render and deliver, and how they end; or do not.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "proto/retry.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/blob_cache.hpp"
#include "worker/hang_watchdog.hpp"
#include "worker/render_loop.hpp"
#include "worker/sync_loop.hpp"

namespace tessera::worker {

class Worker {
 public:
  struct Options {
    // How long a stopping worker tries to deliver what it has rendered.
    proto::Duration drain_deadline = std::chrono::seconds(20);
    // What is the matter where no coordinator is reached.
    SyncLoop::Explain explain = [](const grpc::Status& status) { return proto::error_from_grpc(status); };
    RenderLoop::Render render = core::render;
    // How long a piece is rendered for nobody before it is taken for endless.
    LeaseTracker::HangTimeout hang_timeout = [](const UnwantedPiece& piece) {
      return compute_hang_timeout(piece, 0);
    };
    // Replaces this process, since nothing ends the threads that are at such a piece. Called when everything
    // else is delivered. Should it return, the piece is waited for.
    std::function<void(const UnwantedPiece&, const core::Status&)> self_restart = [](const UnwantedPiece&,
                                                                                     const core::Status&) {};
  };

  // All three must outlive the worker.
  Worker(Identity identity, const BlobCache& cache, v1::WorkerService::StubInterface& coordinator)
      : Worker(std::move(identity), cache, coordinator, Options{}) {}
  Worker(Identity identity, const BlobCache& cache, v1::WorkerService::StubInterface& coordinator,
         Options options);

  // Works until a stop is requested, then finishes the piece in hand (unless that is taken for endless),
  // delivers what is rendered, takes leave and returns. Error: the coordinator never accepted its
  // credentials.
  core::Status run(const std::stop_token& stop);

 private:
  const Identity identity_;
  const BlobCache& cache_;
  v1::WorkerService::StubInterface& coordinator_;
  const Options options_;
};

}  // namespace tessera::worker
