// SPDX-License-Identifier: Apache-2.0
// One waiting call of Synchronize.
#pragma once

#include <memory>
#include <string>

#include "core/base/mutex.hpp"
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
  void on_cancel() override;
  void synchronize();
  void give(core::Result<v1::SynchronizeResponse> result);

  server::Coordinator& coordinator_;
  base::ThreadPool& pool_;
  std::unique_ptr<v1::SynchronizeRequest> request_ = std::make_unique<v1::SynchronizeRequest>();
  core::Mutex mutex_;
  std::string worker_ TESSERA_GUARDED_BY(mutex_);  // empty until the call begins
};

}  // namespace tessera::rpc
