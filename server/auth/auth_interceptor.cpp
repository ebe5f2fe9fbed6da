// SPDX-License-Identifier: Apache-2.0
#include "server/auth/auth_interceptor.hpp"

#include <fmt/format.h>

#include "proto/peer_address.hpp"
#include "proto/status.hpp"
#include "server/auth/credentials.hpp"

namespace tessera::auth {

namespace {

std::string key_of(const CallerShown& shown, Role role, const Principal& caller, bool is_open) {
  if (role == Role::kWork) return "worker " + shown.connection;
  return is_open ? caller.machine : base::caller_key(caller.name);
}

void reject_for_now(Rejection& rejection, const core::Error& error,
                    std::chrono::steady_clock::duration wait) {
  rejection.temporary = server::temporary(error, wait);
  rejection.status = proto::to_grpc(*rejection.temporary);
}

}  // namespace

std::shared_ptr<const Access> AuthInterceptor::access() const {
  const core::MutexLock lock(mutex_);
  return access_;
}

void AuthInterceptor::replace_access(Access access) {
  auto replacement = std::make_shared<const Access>(std::move(access));
  const core::MutexLock lock(mutex_);
  access_.swap(replacement);
}

std::optional<Admission> AuthInterceptor::admit(const CallerShown& shown, const Method& method,
                                                Rejection& rejection) {
  const std::shared_ptr<const Access> access = this->access();
  Principal caller;
  rejection.status = proto::with_details(
      access->admit(shown.credentials, method.role, std::chrono::system_clock::now(), caller));
  caller.machine = shown.machine;
  auto place = calls_.take(shown.machine);
  if (!rejection.status.ok()) {
    if (rejections_.note(shown.machine, method.path, rejection.status) && place)
      rejection.held_back.emplace(*std::move(place));
    return std::nullopt;
  }
  if (!place) {
    reject_for_now(rejection,
                   server::over_share(calls_.held_by(shown.machine), "calls", "are in progress",
                                      limits_.calls, "--max-calls"),
                   kTryAgainAfter);
    return std::nullopt;
  }
  caller.key = key_of(shown, method.role, caller, access->is_open());
  const auto wait = rate_.take(caller.key);
  if (!wait) return Admission{method, std::move(caller), *std::move(place)};
  reject_for_now(rejection,
                 server::over_limit("there are too many calls from here",
                                    fmt::format("{} a second from each caller", rate_.calls_per_second()),
                                    "--max-calls-per-second"),
                 *wait);
  return std::nullopt;
}

std::optional<Admission> AuthInterceptor::admit(grpc::CallbackServerContext& context, const Method& method,
                                                Rejection& rejection) {
  const std::string connection = context.peer();
  auto admission = admit({shown_by(context), proto::address_key(connection), connection}, method, rejection);
  if (rejection.temporary)
    rejection.status = proto::to_grpc(core::Status(core::fail(*rejection.temporary)), context);
  return admission;
}

grpc::Status try_later(grpc::CallbackServerContext& context, const core::Error& error,
                       std::chrono::steady_clock::duration wait) {
  return proto::to_grpc(core::fail(server::temporary(error, wait)), context);
}

}  // namespace tessera::auth
