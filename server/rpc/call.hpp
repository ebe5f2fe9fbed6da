// SPDX-License-Identifier: Apache-2.0
// Calls as gRPC hands them over: raw bytes, nothing of which is read before the caller is admitted, or parsed
// before its size and structure are checked.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "core/base/error.hpp"
#include "server/rpc/auth_interceptor.hpp"
#include "server/rpc/stream_limits.hpp"

namespace tessera::rpc {

// To gRPC every method has a stream of bytes either way; to the wire a unary one is the same.
using Reactor = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

// Parses a message of the caller, if it is within the limits of its method.
core::Status parse_message(const Method& method, grpc::ByteBuffer& bytes, google::protobuf::Message& message);
core::Result<grpc::ByteBuffer> serialise(const google::protobuf::Message& message);

// A call that is not admitted. Owned by gRPC until OnDone.
class RejectedCall final : public Reactor, private WatchedStream {
 public:
  RejectedCall(Rejection rejection, StallWatch& stalls);

 private:
  void OnDone() override;
  void OnCancel() override { finish(); }
  void end_if_waiting_since(Clock::time_point) override;
  void finish();

  const Rejection rejection_;
  StallWatch& stalls_;
  const Clock::time_point since_ = Clock::now();
  std::once_flag finished_;
};

// A call with one message of the caller, which is read first. The caller must send it, and take an unary
// answer, within StreamLimits::stalls and the time that a slow line takes for it. Owned by gRPC until OnDone.
class RequestCall : public Reactor, protected WatchedStream {
 public:
  // Once it is constructed. Reads the message; then begin() is called, on a thread of gRPC.
  void start();

  grpc::CallbackServerContext& context() const { return context_; }
  const Caller& caller() const { return admission_.caller; }

  // Sends the one message of the answer, if it fits among the answers that were not taken yet, and ends the
  // call.
  void answer(const google::protobuf::Message& response);

 protected:
  RequestCall(grpc::CallbackServerContext& context, StreamLimits& streams, Admission admission)
      : context_(context), streams_(streams), admission_(std::move(admission)) {}

  virtual google::protobuf::Message& message() = 0;
  virtual void begin() = 0;
  // As WatchedStream::end_if_waiting_since(), for what the derived class waits for.
  virtual void end_own_wait_since(Clock::time_point) {}
  // The caller has gone since begin() was called, which may still be under way.
  virtual void on_cancel() {}
  // To be called last by those who override it: deletes the call.
  void OnDone() override;

  StreamLimits& streams() { return streams_; }

 private:
  enum class Stage { kNew, kReading, kParsing, kRunning, kAnswering, kEnded };

  void OnReadDone(bool ok) final;
  void OnCancel() final;
  void end_if_waiting_since(Clock::time_point time) final;
  // False if the call was ended meanwhile.
  bool enter(Stage stage, std::size_t bytes);
  core::Status take_message(bool ok);
  // From then on the derived class ends the call.
  core::Status hand_over();

  grpc::CallbackServerContext& context_;
  StreamLimits& streams_;
  const Admission admission_;
  grpc::ByteBuffer bytes_;
  std::optional<coordinator::FairShare::Held> answer_place_;

  std::mutex mutex_;
  Stage stage_ = Stage::kNew;     // guarded by mutex_
  bool cancelled_ = false;        // guarded by mutex_
  Clock::time_point patient_to_;  // guarded by mutex_; while it reads or answers, but for the stall time
};

// A call with one message either way.
template <typename Request, typename Response>
class UnaryCall final : public RequestCall {
 public:
  // Must see to it that finish() is called once.
  using Handler = std::function<void(UnaryCall&)>;

  UnaryCall(grpc::CallbackServerContext& context, StreamLimits& streams, Admission admission, Handler handler)
      : RequestCall(context, streams, std::move(admission)), handler_(std::move(handler)) {}

  Request& request() { return request_; }
  Response& response() { return response_; }

  // On any thread. Afterwards the call may be gone at any moment.
  void finish(const grpc::Status& status) { status.ok() ? answer(response_) : Finish(status); }

 private:
  google::protobuf::Message& message() override { return request_; }
  void begin() override { handler_(*this); }

  const Handler handler_;
  Request request_;
  Response response_;
};

}  // namespace tessera::rpc
