// One call of WatchJob.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <chrono>
#include <optional>
#include <string>

#include "server/rpc/watch_hub.hpp"

namespace tessera::rpc {

// Owned by gRPC until OnDone. Members are guarded by the hub's mutex. One write is in flight at a time, and
// Finish waits for it; what the client is too slow for is skipped.
class WatchCall final : public grpc::ServerWriteReactor<v1::WatchJobResponse>, private Watcher {
 public:
  WatchCall(WatchHub& hub, std::string job_id);

 private:
  const std::string& job_id() const override { return job_id_; }
  void tell(const core::Result<v1::Job>& job) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  void write(const v1::Job& job);
  // Finishes the call now or after the write in flight. The first status counts.
  void end(grpc::Status status);

  WatchHub& hub_;
  const std::string job_id_;
  v1::WatchJobResponse response_;
  std::string last_sent_;  // serialised
  std::chrono::steady_clock::time_point last_sent_at_{};
  bool writing_ = false;
  bool finished_ = false;
  std::optional<grpc::Status> ending_;
};

}  // namespace tessera::rpc
