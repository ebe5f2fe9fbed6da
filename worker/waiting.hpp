// SPDX-License-Identifier: Apache-2.0
// Waits and calls that end early after a stop request. Thread-safe.
#pragma once

#include <grpcpp/client_context.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <stop_token>
#include <thread>

#include "proto/retry.hpp"

namespace tessera::worker {

// Returns false if a stop ended the wait.
bool wait_for(const std::stop_token& stop, proto::Duration duration);

// The real clock for proto::retry; its waits end with a stop.
proto::Waiter waiter_until(const std::stop_token& stop);

// A client context with a deadline from now. A stop cancels its call.
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

// The timeout for one chunk of a blob, of up to a mebibyte, so that lines of a few kilobytes a second
// suffice. The channel's keepalive detects a peer that vanished long before.
inline constexpr std::chrono::minutes kMaxSilence{5};

// Ends a stream that makes no progress for too long, however long it takes in total.
class StallGuard {
 public:
  // `cancel` is called by another thread, at most once.
  StallGuard(std::function<void()> cancel, proto::Duration max_silence);
  // Records progress.
  void progressed() { last_ = std::chrono::steady_clock::now().time_since_epoch(); }

 private:
  std::atomic<std::chrono::steady_clock::duration> last_;
  std::jthread watch_;
};

}  // namespace tessera::worker
