// SPDX-License-Identifier: Apache-2.0
// A service whose methods authenticate the caller before they read a message. Thread-safe once it is served.
#pragma once

#include <grpcpp/impl/service_type.h>

#include <functional>
#include <string>
#include <utility>

#include "server/rpc/call.hpp"

namespace tessera::rpc {

class GuardedService : public grpc::Service {
 public:
  // `name`: "tessera.v1.RenderService".
  GuardedService(std::string name, auth::AuthInterceptor& gate, StreamLimits& streams)
      : name_(std::move(name)), auth_(gate), streams_(streams) {}

 protected:
  using Make = std::function<Reactor*(grpc::CallbackServerContext&, auth::Admission)>;

  // Registers a method, served by the reactor that `make` returns for each admitted call.
  void add(const std::string& method, Make make);

  // Registers a unary method, served by a member function that finishes the call, now or later.
  template <typename Derived, typename Request, typename Response>
  void add_unary(const std::string& method, void (Derived::*handle)(UnaryCall<Request, Response>&)) {
    auto* const self = static_cast<Derived*>(this);
    add_call(method, [this, self, handle](grpc::CallbackServerContext& context, auth::Admission admission) {
      return new UnaryCall<Request, Response>(
          context, streams_, std::move(admission),
          [self, handle](UnaryCall<Request, Response>& call) { (self->*handle)(call); });
    });
  }

  // Registers a method, served by a class that is derived from RequestCall.
  template <typename MakeCall>
  void add_call(const std::string& method, MakeCall make) {
    add(method, [make](grpc::CallbackServerContext& context, auth::Admission admission) -> Reactor* {
      auto* const call = make(context, std::move(admission));
      call->start();
      return call;
    });
  }

 private:
  Reactor* open(grpc::CallbackServerContext& context, const auth::Method& method, const Make& make);

  const std::string name_;
  auth::AuthInterceptor& auth_;
  StreamLimits& streams_;
  int method_count_ = 0;
};

}  // namespace tessera::rpc
