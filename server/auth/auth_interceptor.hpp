// SPDX-License-Identifier: Apache-2.0
// Admits calls before their message is read: checks the caller's role, the number of calls in progress, and
// how often the caller calls. Thread-safe.
#pragma once

#include <grpcpp/server_context.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "server/auth/access.hpp"
#include "server/auth/call_rate.hpp"
#include "server/auth/methods.hpp"
#include "server/auth/rejections.hpp"
#include "server/base/fair_share.hpp"
#include "server/limits.hpp"

namespace tessera::auth {

// A call that is admitted.
struct Admission {
  const Method& method;
  Caller caller;
  base::FairShare::Held place;  // its share of the calls in progress
};

// A call that is rejected.
struct Rejection {
  grpc::Status status;
  // Present if the answer must be delayed: the call's share of the calls in progress.
  std::optional<base::FairShare::Held> held_back{};
};

class AuthInterceptor {
 public:
  AuthInterceptor(Access access, const server::Limits& limits)
      : limits_(limits),
        methods_(limits),
        access_(std::move(access)),
        calls_(limits.calls),
        rate_(limits.calls_per_second) {}

  const Methods& methods() const { return methods_; }

  // Returns the caller, with its key and its share of the calls in progress; or nothing, with the reason in
  // `rejection`. Besides the codes of Access::admit(), RESOURCE_EXHAUSTED with try_later() for a caller that
  // calls too often or has too many calls in progress. The keys of users are the names of their tokens, or
  // their machines without tokens; those of workers are their connections. Shares of the calls in progress
  // are by machine.
  std::optional<Admission> admit(grpc::CallbackServerContext& context, const Method& method,
                                 Rejection& rejection);
  // See Rejections::flush(). Call it regularly.
  void flush_log() { rejections_.flush(); }

 private:
  const server::Limits limits_;
  const Methods methods_;
  const Access access_;
  base::FairShare calls_;
  CallRate rate_;
  Rejections rejections_;
};

// A RESOURCE_EXHAUSTED status for a temporary condition. It carries the delay before a retry in gRPC's own
// form (proto/status.hpp). The default is a second.
inline constexpr std::chrono::seconds kTryAgainAfter{1};
grpc::Status try_later(grpc::CallbackServerContext& context, const core::Error& error,
                       std::chrono::steady_clock::duration wait);

}  // namespace tessera::auth
