// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/auth_interceptor.hpp"

#include <fmt/format.h>

#include "proto/status.hpp"
#include "server/coordinator/fair_share.hpp"
#include "server/rpc/connection_slots.hpp"

namespace tessera::rpc {

namespace {

std::string key_of(const grpc::CallbackServerContext& context, Role role, const Caller& caller) {
  if (role == Role::kWork) return "worker " + context.peer();
  return caller.name.empty() ? client_key(context.peer()) : coordinator::caller_key(caller.name);
}

}  // namespace

grpc::Status AuthInterceptor::admit(grpc::CallbackServerContext& context, Role role, Caller& caller) {
  if (const grpc::Status admitted = access_.admit(context, role, caller); !admitted.ok()) return admitted;
  caller.key = key_of(context, role, caller);
  const auto wait = rate_.take(caller.key);
  if (!wait) return grpc::Status::OK;
  return try_later(context,
                   server::over_limit("there are too many calls from here",
                                      fmt::format("{} a second from each caller", rate_.calls_per_second()),
                                      "--max-calls-per-second"),
                   *wait);
}

grpc::Status try_later(grpc::CallbackServerContext& context, const core::Error& error,
                       std::chrono::steady_clock::duration wait) {
  const auto wait_ms = std::chrono::ceil<std::chrono::milliseconds>(wait).count();
  context.AddTrailingMetadata(proto::kRetryAfterKey, std::to_string(wait_ms));
  return proto::to_grpc(error);
}

}  // namespace tessera::rpc
