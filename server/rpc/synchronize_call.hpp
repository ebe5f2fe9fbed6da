// SPDX-License-Identifier: Apache-2.0
// One waiting call of Synchronize.
#pragma once

#include <memory>

#include "server/base/thread_pool.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/call.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::rpc {

// The coordinator answers exactly once; gRPC deletes the call after that.
class SynchronizeCall final : public RequestCall {
 public:
  SynchronizeCall(grpc::CallbackServerContext& context, server::Coordinator& coordinator,
                  base::ThreadPool& pool, StreamLimits& streams, auth::Admission admission)
      : RequestCall(context, streams, std::move(admission)), coordinator_(coordinator), pool_(pool) {}

 private:
  google::protobuf::Message& message() override { return *request_; }
  void begin() override;
  void synchronize();
  void give(core::Result<v1::SynchronizeResponse> result);

  server::Coordinator& coordinator_;
  base::ThreadPool& pool_;
  std::unique_ptr<v1::SynchronizeRequest> request_ = std::make_unique<v1::SynchronizeRequest>();
};

}  // namespace tessera::rpc
