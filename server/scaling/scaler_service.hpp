// SPDX-License-Identifier: Apache-2.0
// The external scaler that KEDA calls: the backlog as a metric of which each worker should have so many
// seconds (the metadata secondsPerWorker of the trigger). Thread-safe.
#pragma once

#include <atomic>

#include "externalscaler.grpc.pb.h"
#include "server/scaling/backlog_board.hpp"

namespace tessera::scaling {

class ScalerService final : public externalscaler::ExternalScaler::Service {
 public:
  static constexpr const char* kMetric = "backlog_worker_seconds";
  static constexpr const char* kTargetKey = "secondsPerWorker";
  static constexpr double kDefaultTarget = 120;
  static constexpr int kMaxStreams = 8;  // each holds a thread

  // The board must outlive the service.
  explicit ScalerService(BacklogBoard& board) : board_(board) {}

  grpc::Status IsActive(grpc::ServerContext* context, const externalscaler::ScaledObjectRef* request,
                        externalscaler::IsActiveResponse* response) override;
  // RESOURCE_EXHAUSTED beyond kMaxStreams.
  grpc::Status StreamIsActive(grpc::ServerContext* context, const externalscaler::ScaledObjectRef* request,
                              grpc::ServerWriter<externalscaler::IsActiveResponse>* writer) override;
  // INVALID_ARGUMENT if secondsPerWorker is no positive number.
  grpc::Status GetMetricSpec(grpc::ServerContext* context, const externalscaler::ScaledObjectRef* request,
                             externalscaler::GetMetricSpecResponse* response) override;
  grpc::Status GetMetrics(grpc::ServerContext* context, const externalscaler::GetMetricsRequest* request,
                          externalscaler::GetMetricsResponse* response) override;

 private:
  void send_changes(grpc::ServerContext& context,
                    grpc::ServerWriter<externalscaler::IsActiveResponse>& writer);

  BacklogBoard& board_;
  std::atomic<int> streams_ = 0;
};

}  // namespace tessera::scaling
