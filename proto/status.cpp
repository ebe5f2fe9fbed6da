// SPDX-License-Identifier: Apache-2.0
#include "proto/status.hpp"

#include <cassert>
#include <charconv>
#include <cstdint>
#include <system_error>

#include "core/base/printable.hpp"

namespace tessera::proto {
namespace {

using core::ErrorCode;
using grpc::StatusCode;

StatusCode code_to_grpc(ErrorCode code) {
  switch (code) {
    case ErrorCode::kCancelled:
      return StatusCode::CANCELLED;
    case ErrorCode::kInvalidArgument:
      return StatusCode::INVALID_ARGUMENT;
    case ErrorCode::kNotFound:
      return StatusCode::NOT_FOUND;
    case ErrorCode::kAlreadyExists:
      return StatusCode::ALREADY_EXISTS;
    case ErrorCode::kPermissionDenied:
      return StatusCode::PERMISSION_DENIED;
    case ErrorCode::kResourceExhausted:
      return StatusCode::RESOURCE_EXHAUSTED;
    case ErrorCode::kFailedPrecondition:
      return StatusCode::FAILED_PRECONDITION;
    case ErrorCode::kUnavailable:
      return StatusCode::UNAVAILABLE;
    case ErrorCode::kDeadlineExceeded:
      return StatusCode::DEADLINE_EXCEEDED;
    case ErrorCode::kDataLoss:
      return StatusCode::DATA_LOSS;
    case ErrorCode::kInternal:
      return StatusCode::INTERNAL;
  }
  return StatusCode::INTERNAL;
}

ErrorCode code_from_grpc(StatusCode code) {
  switch (code) {
    case StatusCode::CANCELLED:
      return ErrorCode::kCancelled;
    case StatusCode::INVALID_ARGUMENT:
    case StatusCode::OUT_OF_RANGE:
      return ErrorCode::kInvalidArgument;
    case StatusCode::NOT_FOUND:
      return ErrorCode::kNotFound;
    case StatusCode::ALREADY_EXISTS:
      return ErrorCode::kAlreadyExists;
    case StatusCode::PERMISSION_DENIED:
    case StatusCode::UNAUTHENTICATED:
      return ErrorCode::kPermissionDenied;
    case StatusCode::RESOURCE_EXHAUSTED:
      return ErrorCode::kResourceExhausted;
    case StatusCode::FAILED_PRECONDITION:
    case StatusCode::UNIMPLEMENTED:
      return ErrorCode::kFailedPrecondition;
    case StatusCode::UNAVAILABLE:
    case StatusCode::ABORTED:
      return ErrorCode::kUnavailable;
    case StatusCode::DEADLINE_EXCEEDED:
      return ErrorCode::kDeadlineExceeded;
    case StatusCode::DATA_LOSS:
      return ErrorCode::kDataLoss;
    default:
      return ErrorCode::kInternal;
  }
}

}  // namespace

grpc::Status to_grpc(const core::Error& error) {
  return {code_to_grpc(error.code), core::printable_lines(error.message)};
}

grpc::Status to_grpc(const core::Status& status) {
  return status.has_value() ? grpc::Status::OK : to_grpc(status.error());
}

core::Error error_from_grpc(const grpc::Status& status) {
  assert(!status.ok());
  if (status.error_code() == StatusCode::UNIMPLEMENTED)
    return {ErrorCode::kFailedPrecondition,
            "the other side does not know this call: use the same release of Tessera on both"};
  return {code_from_grpc(status.error_code()), status.error_message()};
}

std::optional<std::chrono::milliseconds> asked_wait(const grpc::Status& status,
                                                    const grpc::ClientContext& call) {
  if (status.error_code() != StatusCode::RESOURCE_EXHAUSTED) return std::nullopt;
  const auto found = call.GetServerTrailingMetadata().find(kRetryAfterKey);
  if (found == call.GetServerTrailingMetadata().end()) return std::nullopt;
  const char* const end = found->second.data() + found->second.size();
  std::uint32_t wait_ms = 0;
  const auto read = std::from_chars(found->second.data(), end, wait_ms);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return std::chrono::milliseconds(wait_ms);
}

core::Error error_from_grpc(const grpc::Status& status, const grpc::ClientContext& call) {
  core::Error error = error_from_grpc(status);
  if (asked_wait(status, call)) error.code = ErrorCode::kUnavailable;
  return error;
}

core::Status from_grpc(const grpc::Status& status) {
  if (status.ok()) return {};
  return core::fail(error_from_grpc(status));
}

}  // namespace tessera::proto
