// Waits and calls that end early when a stop is requested. Thread-safe.
#pragma once

#include <grpcpp/client_context.h>

#include <chrono>
#include <stop_token>

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
  grpc::ClientContext* context() { return &context_; }

 private:
  struct Cancel {
    grpc::ClientContext* context;
    void operator()() const { context->TryCancel(); }
  };
  grpc::ClientContext context_;
  std::stop_callback<Cancel> on_stop_;
};

}  // namespace tessera::worker
