// SPDX-License-Identifier: Apache-2.0
// Admits calls, of gRPC and of HTTP, before their message is read: identifies the principal by what the call
// shows and by its connection, and checks its role, the number of calls in progress, and how often it calls.
// Thread-safe.
#pragma once

#include <grpcpp/server_context.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/base/mutex.hpp"
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
  Principal caller;
  base::FairShare::Held place;  // its share of the calls in progress
};

// Who calls, before that is checked.
struct CallerShown {
  Credentials credentials{};
  std::string machine;  // peer.hpp
  // The connection, by which workers are told apart; only methods for workers need it.
  std::string connection{};
};

// A call that is rejected.
struct Rejection {
  grpc::Status status;
  // The same, if it passes by itself: the details have the delay before a retry.
  std::optional<core::Error> temporary{};
  // Present if the answer must be delayed: the call's share of the calls in progress.
  std::optional<base::FairShare::Held> held_back{};
};

class AuthInterceptor {
 public:
  AuthInterceptor(Access access, const server::Limits& limits)
      : limits_(limits),
        methods_(limits),
        access_(std::make_shared<const Access>(std::move(access))),
        calls_(limits.calls),
        rate_(limits.calls_per_second) {}

  const Methods& methods() const { return methods_; }

  // Later calls are admitted by these tokens and certificates. Calls in progress continue.
  void replace_access(Access access);

  // Returns the caller, with its key and its share of the calls in progress; or nothing, with the reason in
  // `rejection`. Besides the codes of Access::admit(), RESOURCE_EXHAUSTED with try_later() for a caller that
  // calls too often or has too many calls in progress. The keys of users are their names, or on an
  // open farm their machines; those of workers are their connections. Shares of the calls in progress
  // are by machine.
  std::optional<Admission> admit(const CallerShown& caller, const Method& method, Rejection& rejection);
  // The same for a call of gRPC, whose metadata get the delay before a retry.
  std::optional<Admission> admit(grpc::CallbackServerContext& context, const Method& method,
                                 Rejection& rejection);
  bool is_open() const { return access()->is_open(); }
  // See Rejections::flush(). Call it regularly.
  void flush_log() { rejections_.flush(); }

 private:
  std::shared_ptr<const Access> access() const;

  const server::Limits limits_;
  const Methods methods_;
  mutable core::Mutex mutex_;
  std::shared_ptr<const Access> access_ TESSERA_GUARDED_BY(mutex_);  // never null
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
