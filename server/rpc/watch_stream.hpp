// SPDX-License-Identifier: Apache-2.0
// A call that sends messages as what it watches changes.
#pragma once

#include <optional>
#include <string>

#include "core/base/mutex.hpp"
#include "server/base/fair_pool.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/call.hpp"
#include "server/rpc/watch_hub.hpp"

namespace tessera::rpc {

// Owned by gRPC until OnDone. Its steps, each of which makes at most one message, run one after the other on
// a pool; the next one waits until the message is sent. So a slow reader gets fewer and newer messages, and
// one that reads nothing is ended.
//
//   waiting ──change, pause over──► making a message ──► sending
//      ▲                                 │ nothing to send   │
//      └─────────────────────────────────┴───────────────────┘
class WatchStream : public RequestCall, private Watcher {
 public:
  WatchStream(grpc::CallbackServerContext& context, server::Coordinator& coordinator, WatchHub& hub,
              base::FairPool& pool, StreamLimits& streams, auth::Admission admission)
      : RequestCall(context, streams, std::move(admission)),
        coordinator_(coordinator),
        hub_(hub),
        pool_(pool) {}

 protected:
  struct Step {
    const google::protobuf::Message* message = nullptr;  // null: there is nothing to send
    bool has_more = false;                               // there is more to send at this moment
    bool is_last = false;                                // the call ends after the message
    Clock::duration pause{};                             // before the next step
  };

  server::Coordinator& coordinator() { return coordinator_; }
  // The next message. Never called twice at a time. An error ends the call.
  virtual core::Result<Step> next() = 0;

 private:
  void begin() final;
  bool notify(bool changed) final;
  void close() final;
  void end_own_wait_since(Clock::time_point time) final;
  void OnWriteDone(bool ok) final;
  void on_cancel() final;
  void OnDone() final;
  void step();

  void step_if_due() TESSERA_REQUIRES(mutex_);
  void send(const Step& step) TESSERA_REQUIRES(mutex_);
  // Finishes the call now, or after the step or write in progress. The first status is used.
  void end(grpc::Status status) TESSERA_REQUIRES(mutex_);
  void finish_if_ended() TESSERA_REQUIRES(mutex_);

  server::Coordinator& coordinator_;
  WatchHub& hub_;
  base::FairPool& pool_;
  std::optional<base::FairShare::Held> place_;  // its share of streams.watches

  core::Mutex mutex_;
  bool is_due_ TESSERA_GUARDED_BY(mutex_) = false;   // something has changed since the last step began
  bool is_busy_ TESSERA_GUARDED_BY(mutex_) = false;  // a step runs, or its message is being sent
  Clock::time_point paused_until_ TESSERA_GUARDED_BY(mutex_){};
  std::optional<Clock::time_point> sending_since_ TESSERA_GUARDED_BY(mutex_);
  grpc::ByteBuffer bytes_ TESSERA_GUARDED_BY(mutex_);
  std::optional<grpc::Status> ending_ TESSERA_GUARDED_BY(mutex_);
  bool is_finished_ TESSERA_GUARDED_BY(mutex_) = false;
};

}  // namespace tessera::rpc
