// SPDX-License-Identifier: Apache-2.0
#include "server/auth/auth_interceptor.hpp"

#include <fmt/format.h>

#include "proto/status.hpp"
#include "server/auth/peer.hpp"

namespace tessera::auth {

namespace {

std::string key_of(const grpc::CallbackServerContext& context, Role role, const Caller& caller) {
  if (role == Role::kWork) return "worker " + context.peer();
  return caller.name.empty() ? client_key(context.peer()) : base::caller_key(caller.name);
}

}  // namespace

std::optional<Admission> AuthInterceptor::admit(grpc::CallbackServerContext& context, const Method& method,
                                                Rejection& rejection) {
  const std::string machine = client_key(context.peer());
  Caller caller;
  rejection.status = access_.admit(context, method.role, caller);
  auto place = calls_.take(machine);
  if (!rejection.status.ok()) {
    if (rejections_.note(machine, method.path, rejection.status) && place)
      rejection.held_back.emplace(*std::move(place));
    return std::nullopt;
  }
  if (!place) {
    rejection.status = try_later(
        context,
        server::over_share(calls_.held_by(machine), "calls", "are in progress", limits_.calls, "--max-calls"),
        kTryAgainAfter);
    return std::nullopt;
  }
  caller.key = key_of(context, method.role, caller);
  const auto wait = rate_.take(caller.key);
  if (!wait) return Admission{method, std::move(caller), *std::move(place)};
  rejection.status =
      try_later(context,
                server::over_limit("there are too many calls from here",
                                   fmt::format("{} a second from each caller", rate_.calls_per_second()),
                                   "--max-calls-per-second"),
                *wait);
  return std::nullopt;
}

grpc::Status try_later(grpc::CallbackServerContext& context, const core::Error& error,
                       std::chrono::steady_clock::duration wait) {
  const auto wait_ms = std::chrono::ceil<std::chrono::milliseconds>(wait).count();
  context.AddTrailingMetadata(proto::kRetryAfterKey, std::to_string(wait_ms));
  return proto::to_grpc(error);
}

}  // namespace tessera::auth
