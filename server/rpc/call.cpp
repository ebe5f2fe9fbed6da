// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/call.hpp"

#include <fmt/format.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/proto_buffer_reader.h>
#include <grpcpp/support/proto_buffer_writer.h>

#include <chrono>
#include <new>

#include "proto/status.hpp"
#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

namespace {

using core::ErrorCode;

// The approximate delay of the answer to a machine that is rejected often.
constexpr std::chrono::seconds kHoldBack{1};

// The slowest line over which a message or an answer arrives in time.
constexpr std::size_t kSlowestBytesPerSecond = 16 << 10;

std::chrono::seconds time_on_slow_line(std::size_t bytes) {
  return std::chrono::seconds(bytes / kSlowestBytesPerSecond);
}

}  // namespace

core::Status parse_message(const auth::Method& method, grpc::ByteBuffer& bytes,
                           google::protobuf::Message& message) {
  if (bytes.Length() > method.max_bytes)
    return core::fail(ErrorCode::kResourceExhausted,
                      fmt::format("the message has {} bytes, and {} takes at most {}", bytes.Length(),
                                  method.path, method.max_bytes));
  if (auto fits = auth::check_shape(bytes, *message.GetDescriptor(), method.shape); !fits) return fits;
  if (grpc::GenericDeserialize<grpc::ProtoBufferReader, google::protobuf::Message>(&bytes, &message).ok())
    return {};
  return core::fail(ErrorCode::kInvalidArgument,
                    "the message cannot be read: each text in it must be UTF-8, and each field of the type "
                    "that the contract gives it");
}

core::Result<grpc::ByteBuffer> serialise(const google::protobuf::Message& message) {
  grpc::ByteBuffer bytes;
  bool own_buffer = false;
  const grpc::Status done = grpc::GenericSerialize<grpc::ProtoBufferWriter, google::protobuf::Message>(
      message, &bytes, &own_buffer);
  if (!done.ok()) return core::fail(ErrorCode::kInternal, "the answer cannot be encoded");
  return bytes;
}

RejectedCall::RejectedCall(auth::Rejection rejection, StreamLimits& streams, const auth::Method& method)
    : Reactor(streams.calls, method), rejection_(std::move(rejection)), stalls_(streams.stalls) {
  streams.calls.note_rejected(rejection_.status);
  stalls_.add(*this);
  if (!rejection_.held_back) finish();
}

void RejectedCall::end_if_waiting_since(Clock::time_point) {
  if (Clock::now() - since_ >= kHoldBack) finish();
}

void RejectedCall::finish() {
  std::call_once(finished_, [this] { Finish(rejection_.status); });
}

void RejectedCall::OnDone() {
  stalls_.remove(*this);
  delete this;
}

void RequestCall::start() {
  streams_.stalls.add(*this);
  enter(Stage::kReading, admission_.method.max_bytes);
  StartRead(&bytes_);
}

bool RequestCall::enter(Stage stage, std::size_t bytes) {
  const core::MutexLock lock(mutex_);
  if (stage_ == Stage::kEnded) return false;
  stage_ = stage;
  patient_to_ = Clock::now() + time_on_slow_line(bytes);
  return true;
}

// gRPC does not delete the call before OnReadDone returns.
void RequestCall::OnReadDone(bool ok) {
  if (!enter(Stage::kParsing, 0)) return;
  core::Status done = guarded([&] { return take_message(ok); });
  if (done) done = hand_over();
  if (done)
    done = guarded([&]() -> core::Status {
      begin();
      return {};
    });
  if (!done) Finish(proto::to_grpc(done));
}

core::Status RequestCall::take_message(bool ok) {
  if (!ok) return core::fail(ErrorCode::kInvalidArgument, "the call ended before its message had come");
  if (auto parsed = parse_message(admission_.method, bytes_, message()); !parsed) return parsed;
  bytes_.Clear();
  return {};
}

core::Status RequestCall::hand_over() {
  const core::MutexLock lock(mutex_);
  if (cancelled_) return core::fail(ErrorCode::kCancelled, "the caller has gone");
  stage_ = Stage::kRunning;
  return {};
}

void RequestCall::OnCancel() {
  {
    const core::MutexLock lock(mutex_);
    cancelled_ = true;
    if (stage_ != Stage::kRunning) return;
  }
  on_cancel();
}

void RequestCall::answer(const google::protobuf::Message& response) {
  const core::Status ready = guarded([&]() -> core::Status {
    auto bytes = serialise(response);
    if (!bytes) return core::fail(bytes.error());
    bytes_ = *std::move(bytes);
    return {};
  });
  if (!ready) return Finish(proto::to_grpc(ready));
  auto place = streams_.answers.take(caller().key, bytes_.Length());
  if (!place) {
    const core::Error error = {
        ErrorCode::kResourceExhausted,
        fmt::format("the answer has {} bytes, and {} bytes of earlier answers to this caller were not taken "
                    "yet: read them first",
                    bytes_.Length(), streams_.answers.held_by(caller().key))};
    return Finish(auth::try_later(context_, error, auth::kTryAgainAfter));
  }
  answer_place_.emplace(*std::move(place));
  enter(Stage::kAnswering, bytes_.Length());
  StartWriteAndFinish(&bytes_, grpc::Status::OK);
}

void RequestCall::end_if_waiting_since(Clock::time_point time) {
  {
    const core::MutexLock lock(mutex_);
    const bool late = patient_to_ <= time;
    if (stage_ == Stage::kAnswering && late) return context_.TryCancel();
    if (stage_ == Stage::kReading && late) {
      stage_ = Stage::kEnded;
      const std::chrono::duration<double> longest =
          streams_.stalls.patience() + time_on_slow_line(admission_.method.max_bytes);
      return Finish(proto::to_grpc(
          core::Error{ErrorCode::kDeadlineExceeded,
                      fmt::format("the message of this call has not come within {} s (tessera-coordinator "
                                  "--stall-seconds): call again",
                                  longest.count())}));
    }
    if (stage_ != Stage::kRunning) return;
  }
  end_own_wait_since(time);
}

void RequestCall::OnDone() {
  streams_.stalls.remove(*this);
  { const core::MutexLock whoever_ended_it_is_done(mutex_); }
  delete this;
}

}  // namespace tessera::rpc
