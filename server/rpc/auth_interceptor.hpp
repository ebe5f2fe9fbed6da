// SPDX-License-Identifier: Apache-2.0
// What every call passes first: whether its caller may make it at all, and whether they have not made too
// many. Thread-safe.
#pragma once

#include <grpcpp/server_context.h>

#include <chrono>
#include <string>

#include "server/limits.hpp"
#include "server/rpc/access.hpp"
#include "server/rpc/call_rate.hpp"

namespace tessera::rpc {

class AuthInterceptor {
 public:
  AuthInterceptor(Access access, const server::Limits& limits)
      : access_(std::move(access)), rate_(limits.calls_per_second) {}

  // Who calls, with their key, if they may. Besides the codes of Access::admit(), RESOURCE_EXHAUSTED with
  // try_later() for those who call too often. Users are told apart by the names of their tokens, or else by
  // their machines; workers by their connections.
  grpc::Status admit(grpc::CallbackServerContext& context, Role role, Caller& caller);

 private:
  const Access access_;
  CallRate rate_;
};

// RESOURCE_EXHAUSTED for a reason that passes by itself: says when to try again, in gRPC's own way
// (proto/status.hpp); where nothing better is known, after a second.
inline constexpr std::chrono::seconds kTryAgainAfter{1};
grpc::Status try_later(grpc::CallbackServerContext& context, const core::Error& error,
                       std::chrono::steady_clock::duration wait);

}  // namespace tessera::rpc
