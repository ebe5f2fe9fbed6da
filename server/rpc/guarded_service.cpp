// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/guarded_service.hpp"

#include <grpcpp/impl/codegen/server_callback_handlers.h>
#include <grpcpp/impl/rpc_service_method.h>

#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

using grpc::internal::CallbackBidiHandler;
using grpc::internal::RpcServiceMethod;

// As in generated code, except for the kind of method: gRPC reads the message of a unary method before it
// calls any handler.
void GuardedService::add(const std::string& name, Make make) {
  const auth::Method& method = auth_.methods().at("/" + name_ + "/" + name);
  AddMethod(new RpcServiceMethod(method.path.c_str(), grpc::internal::RpcMethod::BIDI_STREAMING, nullptr));
  const auto open_call = [this, &method, make = std::move(make)](grpc::CallbackServerContext* context) {
    return open(*context, method, make);
  };
  MarkMethodRawCallback(method_count_++,
                        new CallbackBidiHandler<grpc::ByteBuffer, grpc::ByteBuffer>(open_call));
}

Reactor* GuardedService::open(grpc::CallbackServerContext& context, const auth::Method& method,
                              const Make& make) {
  Reactor* reactor = nullptr;
  const core::Status opened = guarded([&]() -> core::Status {
    auth::Rejection rejection;
    auto admission = auth_.admit(context, method, rejection);
    reactor = admission ? make(context, *std::move(admission))
                        : new RejectedCall(std::move(rejection), streams_, method);
    return {};
  });
  if (!opened) reactor = new RejectedCall({proto::to_grpc(opened)}, streams_, method);
  return reactor;
}

}  // namespace tessera::rpc
