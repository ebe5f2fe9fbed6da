// SPDX-License-Identifier: Apache-2.0
// Calls with messages of raw bytes. A message is read only after its caller is admitted, and parsed only
// after its size and structure are checked.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "server/auth/auth_interceptor.hpp"
#include "server/rpc/call_stats.hpp"
#include "server/rpc/stream_limits.hpp"

namespace tessera::rpc {

// gRPC sees a bidirectional stream of bytes for every method. On the wire a unary call looks the same.
using ByteStream = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

// A call that is counted, with its status and the time until it has one.
class Reactor : public ByteStream {
 public:
  void Finish(const grpc::Status& status) {
    timer_.end(status);
    ByteStream::Finish(status);
  }

 protected:
  Reactor(CallStats& stats, const auth::Method& method) : timer_(stats, method) {}

  void StartWriteAndFinish(const grpc::ByteBuffer* bytes, const grpc::Status& status) {
    timer_.end(status);
    ByteStream::StartWriteAndFinish(bytes, grpc::WriteOptions(), status);
  }

 private:
  CallTimer timer_;
};

// Parses a message of the caller. RESOURCE_EXHAUSTED or INVALID_ARGUMENT if it exceeds the limits of its
// method.
core::Status parse_message(const auth::Method& method, grpc::ByteBuffer& bytes,
                           google::protobuf::Message& message);
core::Result<grpc::ByteBuffer> serialise(const google::protobuf::Message& message);

// A call that is not admitted. Owned by gRPC until OnDone.
class RejectedCall final : public Reactor, private WatchedStream {
 public:
  RejectedCall(auth::Rejection rejection, StreamLimits& streams, const auth::Method& method);

 private:
  void OnDone() override;
  void OnCancel() override { finish(); }
  void end_if_waiting_since(Clock::time_point) override;
  void finish();

  const auth::Rejection rejection_;
  StallWatch& stalls_;
  const Clock::time_point since_ = Clock::now();
  std::once_flag finished_;
};

// A call that begins with one message of the caller. The caller must send it, and read a unary answer, within
// the stall time (StreamLimits::stalls) plus the time that a slow line needs for it. Owned by gRPC until
// OnDone.
class RequestCall : public Reactor, protected WatchedStream {
 public:
  // To be called after construction. Reads the message, then calls begin() on a thread of gRPC.
  void start();

  grpc::CallbackServerContext& context() const { return context_; }
  const auth::Principal& caller() const { return admission_.caller; }

  // Sends the answer and ends the call. RESOURCE_EXHAUSTED if too many bytes of answers are unread.
  void answer(const google::protobuf::Message& response);

 protected:
  RequestCall(grpc::CallbackServerContext& context, StreamLimits& streams, auth::Admission admission)
      : Reactor(streams.calls, admission.method),
        context_(context),
        streams_(streams),
        admission_(std::move(admission)) {}

  virtual google::protobuf::Message& message() = 0;
  virtual void begin() = 0;
  // The same as WatchedStream::end_if_waiting_since() for what the derived class waits for.
  virtual void end_own_wait_since(Clock::time_point) {}
  // The call was cancelled after begin() was called, which may still be running.
  virtual void on_cancel() {}
  // Deletes the call: an override calls it last.
  void OnDone() override;

  StreamLimits& streams() { return streams_; }

 private:
  enum class Stage { kNew, kReading, kParsing, kRunning, kAnswering, kEnded };

  void OnReadDone(bool ok) final;
  void OnCancel() final;
  void end_if_waiting_since(Clock::time_point time) final;
  // False if the call has ended.
  bool enter(Stage stage, std::size_t bytes);
  core::Status take_message(bool ok);
  // After it succeeds, the derived class ends the call.
  core::Status hand_over();

  grpc::CallbackServerContext& context_;
  StreamLimits& streams_;
  const auth::Admission admission_;
  grpc::ByteBuffer bytes_;
  std::optional<base::FairShare::Held> answer_place_;

  core::Mutex mutex_;
  Stage stage_ TESSERA_GUARDED_BY(mutex_) = Stage::kNew;
  bool cancelled_ TESSERA_GUARDED_BY(mutex_) = false;
  // When the stall time begins, while it reads or answers.
  Clock::time_point patient_to_ TESSERA_GUARDED_BY(mutex_);
};

// A call with one message either way.
template <typename Request, typename Response>
class UnaryCall final : public RequestCall {
 public:
  // The handler must call finish() exactly once, now or later.
  using Handler = std::function<void(UnaryCall&)>;

  UnaryCall(grpc::CallbackServerContext& context, StreamLimits& streams, auth::Admission admission,
            Handler handler)
      : RequestCall(context, streams, std::move(admission)), handler_(std::move(handler)) {}

  Request& request() { return request_; }
  Response& response() { return *response_; }

  // Ends the call. On any thread. The call may be deleted at any moment after it. The response is freed at
  // once, not when its bytes are sent.
  void finish(const grpc::Status& status) {
    const std::unique_ptr<Response> response = std::move(response_);
    status.ok() ? answer(*response) : Finish(status);
  }

 private:
  google::protobuf::Message& message() override { return request_; }
  void begin() override { handler_(*this); }

  const Handler handler_;
  Request request_;
  std::unique_ptr<Response> response_ = std::make_unique<Response>();
};

}  // namespace tessera::rpc
