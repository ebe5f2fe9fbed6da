// SPDX-License-Identifier: Apache-2.0
// One call of WatchJob.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "server/rpc/call.hpp"
#include "server/rpc/watch_hub.hpp"

namespace tessera::rpc {

// Owned by gRPC until OnDone. One write is in progress at a time, and Finish waits for it. States of the job
// that a slow client cannot take are skipped; a client that reads nothing is ended.
class WatchCall final : public RequestCall, private Watcher {
 public:
  WatchCall(grpc::CallbackServerContext& context, WatchHub& hub, StreamLimits& streams,
            auth::Admission admission)
      : RequestCall(context, streams, std::move(admission)), hub_(hub) {}

 private:
  google::protobuf::Message& message() override { return request_; }
  void begin() override;
  const std::string& job_id() const override { return request_.job_id(); }
  void tell(const core::Result<v1::Job>& job) override;
  void end_own_wait_since(Clock::time_point time) override;
  void OnWriteDone(bool ok) override;
  void on_cancel() override;
  void OnDone() override;

  // ---- The caller holds the lock ----
  void write(const v1::Job& job);
  // Finishes the call now, or after the write in progress. The first status is used.
  void end(grpc::Status status);

  WatchHub& hub_;
  v1::WatchJobRequest request_;
  std::optional<base::FairShare::Held> place_;  // its share of streams.watches

  std::mutex mutex_;
  // Guarded by mutex_:
  v1::WatchJobResponse response_;
  grpc::ByteBuffer bytes_;
  std::string last_sent_;  // the last job sent, serialised
  Clock::time_point last_sent_at_{};
  bool writing_ = false;
  bool finished_ = false;
  std::optional<grpc::Status> ending_;
};

}  // namespace tessera::rpc
