// SPDX-License-Identifier: Apache-2.0
// Waits and calls that end early when a stop is requested. Thread-safe.
#pragma once

#include <grpcpp/client_context.h>

#include <atomic>
#include <chrono>
#include <stop_token>
#include <thread>

#include "proto/retry.hpp"

namespace tessera::worker {

// Whether the whole time passed without a stop.
bool wait_for(const std::stop_token& stop, proto::Duration duration);

// Real time for proto::retry, given up at a stop.
proto::Waiter waiter_until(const std::stop_token& stop);

// A client context with a deadline from now, whose call is cancelled at a stop.
class StoppableCall {
 public:
  StoppableCall(const std::stop_token& stop, proto::Duration deadline);
  // Without a deadline: for streams with a StallGuard.
  explicit StoppableCall(const std::stop_token& stop) : on_stop_(stop, Cancel{&context_}) {}
  grpc::ClientContext* context() { return &context_; }

 private:
  struct Cancel {
    grpc::ClientContext* context;
    void operator()() const { context->TryCancel(); }
  };
  grpc::ClientContext context_;
  std::stop_callback<Cancel> on_stop_;
};

// Cancels a stream on which nothing has come for too long, however long it takes in all.
class StallGuard {
 public:
  // The context must outlive the guard.
  StallGuard(grpc::ClientContext& context, proto::Duration max_silence);
  // Something has come.
  void progressed() { last_ = std::chrono::steady_clock::now().time_since_epoch(); }

 private:
  std::atomic<std::chrono::steady_clock::duration> last_;
  std::jthread watch_;
};

}  // namespace tessera::worker
