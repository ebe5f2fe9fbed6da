// SPDX-License-Identifier: Apache-2.0
// One call of WatchJob.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <mutex>
#include <optional>
#include <string>

#include "server/rpc/stream_limits.hpp"
#include "server/rpc/watch_hub.hpp"

namespace tessera::rpc {

// What a watcher is when it comes.
struct WatchRequest {
  std::string job_id;
  coordinator::FairShare::Held place;  // one of streams.watches
};

// Owned by gRPC until OnDone. One write is in flight at a time, and Finish waits for it; what the client is
// too slow for is skipped, and one who takes nothing is ended.
class WatchCall final : public grpc::ServerWriteReactor<v1::WatchJobResponse>,
                        private Watcher,
                        private WatchedStream {
 public:
  WatchCall(grpc::CallbackServerContext& context, WatchHub& hub, StallWatch& stalls, WatchRequest request);

 private:
  const std::string& job_id() const override { return request_.job_id; }
  void tell(const core::Result<v1::Job>& job) override;
  void end_if_waiting_since(Clock::time_point time) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  // ---- Under the lock ----
  void write(const v1::Job& job);
  // Finishes the call now or after the write in flight. The first status counts.
  void end(grpc::Status status);

  grpc::CallbackServerContext& context_;
  WatchHub& hub_;
  StallWatch& stalls_;
  const WatchRequest request_;

  std::mutex mutex_;
  // Guarded by mutex_:
  v1::WatchJobResponse response_;
  std::string last_sent_;  // serialised
  Clock::time_point last_sent_at_{};
  bool writing_ = false;
  bool finished_ = false;
  std::optional<grpc::Status> ending_;
};

}  // namespace tessera::rpc
