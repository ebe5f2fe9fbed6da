// SPDX-License-Identifier: Apache-2.0
#include "proto/status.hpp"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cstdint>
#include <system_error>
#include <utility>

#include "core/base/printable.hpp"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/error_reasons.hpp"

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
    case ErrorCode::kOutOfRange:
      return StatusCode::OUT_OF_RANGE;
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
      return ErrorCode::kInvalidArgument;
    case StatusCode::OUT_OF_RANGE:
      return ErrorCode::kOutOfRange;
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

constexpr const char* kDomain = "tessera";
constexpr const char* kOptionKey = "option";
constexpr const char* kMissingCountKey = "missing_count";
constexpr const char* kMissingType = "MISSING";

// The name of a status code, the reason of an error that has no other.
const char* name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::kCancelled:
      return "CANCELLED";
    case ErrorCode::kInvalidArgument:
      return "INVALID_ARGUMENT";
    case ErrorCode::kNotFound:
      return "NOT_FOUND";
    case ErrorCode::kAlreadyExists:
      return "ALREADY_EXISTS";
    case ErrorCode::kPermissionDenied:
      return "PERMISSION_DENIED";
    case ErrorCode::kResourceExhausted:
      return kLimitExceeded;
    case ErrorCode::kFailedPrecondition:
      return "FAILED_PRECONDITION";
    case ErrorCode::kUnavailable:
      return "UNAVAILABLE";
    case ErrorCode::kDeadlineExceeded:
      return "DEADLINE_EXCEEDED";
    case ErrorCode::kDataLoss:
      return "DATA_LOSS";
    case ErrorCode::kOutOfRange:
      return "OUT_OF_RANGE";
    case ErrorCode::kInternal:
      return "INTERNAL";
  }
  return "INTERNAL";
}

// Cuts the message between two characters.
std::string bounded(std::string message) {
  if (message.size() <= kMaxStatusBytes) return message;
  std::size_t end = kMaxStatusBytes;
  while (end > 0 && (static_cast<unsigned char>(message[end]) & 0xc0) == 0x80) --end;
  message.resize(end);
  return message + " ...";
}

google::rpc::ErrorInfo info_of(const core::Error& error, const core::ErrorDetails& details) {
  google::rpc::ErrorInfo info;
  info.set_domain(kDomain);
  info.set_reason(details.reason.empty() ? name_of(error.code) : details.reason);
  if (!details.option.empty()) (*info.mutable_metadata())[kOptionKey] = details.option;
  if (!details.missing.empty())
    (*info.mutable_metadata())[kMissingCountKey] = std::to_string(details.missing.size());
  return info;
}

google::rpc::PreconditionFailure missing_things(const core::ErrorDetails& details) {
  google::rpc::PreconditionFailure failure;
  for (const std::string& subject : details.missing) {
    if (static_cast<std::size_t>(failure.violations_size()) == kMaxMissing) break;
    auto& violation = *failure.add_violations();
    violation.set_type(kMissingType);
    violation.set_subject(subject);
  }
  return failure;
}

google::rpc::Status to_wire(const core::Error& error, StatusCode code, const std::string& message) {
  const core::ErrorDetails details = core::details_of(error);
  google::rpc::Status status;
  status.set_code(code);
  status.set_message(message);
  status.add_details()->PackFrom(info_of(error, details));
  if (!details.field.empty()) {
    google::rpc::BadRequest request;
    request.add_field_violations()->set_field(details.field);
    status.add_details()->PackFrom(request);
  }
  if (!details.missing.empty()) status.add_details()->PackFrom(missing_things(details));
  if (details.reason == kQuotaExceeded) {
    google::rpc::QuotaFailure failure;
    failure.add_violations()->set_subject(details.option);
    status.add_details()->PackFrom(failure);
  }
  if (details.retry_delay_ms) {
    google::rpc::RetryInfo retry;
    *retry.mutable_retry_delay() =
        google::protobuf::util::TimeUtil::MillisecondsToDuration(*details.retry_delay_ms);
    status.add_details()->PackFrom(retry);
  }
  return status;
}

// Adds what one detail says. Details of other kinds are ignored.
void take_detail(const google::protobuf::Any& detail, core::ErrorDetails& details) {
  google::rpc::ErrorInfo info;
  google::rpc::BadRequest request;
  google::rpc::PreconditionFailure precondition;
  google::rpc::RetryInfo retry;
  if (detail.UnpackTo(&info) && info.domain() == kDomain) {
    details.reason = info.reason();
    if (const auto option = info.metadata().find(kOptionKey); option != info.metadata().end())
      details.option = option->second;
  } else if (detail.UnpackTo(&request) && request.field_violations_size() > 0) {
    details.field = request.field_violations(0).field();
  } else if (detail.UnpackTo(&precondition)) {
    for (const auto& violation : precondition.violations())
      if (violation.type() == kMissingType) details.missing.push_back(violation.subject());
  } else if (detail.UnpackTo(&retry)) {
    const std::int64_t delay_ms =
        google::protobuf::util::TimeUtil::DurationToMilliseconds(retry.retry_delay());
    details.retry_delay_ms = static_cast<std::uint32_t>(std::clamp<std::int64_t>(delay_ms, 0, UINT32_MAX));
  }
}

// Null if the status has none.
std::shared_ptr<const core::ErrorDetails> details_from(const grpc::Status& status) {
  google::rpc::Status wire;
  if (status.error_details().empty() || !wire.ParseFromString(status.error_details())) return nullptr;
  auto details = std::make_shared<core::ErrorDetails>();
  for (const google::protobuf::Any& detail : wire.details()) take_detail(detail, *details);
  return details;
}

}  // namespace

grpc::Status to_grpc(const core::Error& error) {
  const StatusCode code = code_to_grpc(error.code);
  const std::string message = bounded(core::printable_lines(error.message));
  return {code, message, to_wire(error, code, message).SerializeAsString()};
}

grpc::Status with_details(const grpc::Status& status) {
  if (status.ok() || !status.error_details().empty()) return status;
  core::Error error = error_from_grpc(status);
  if (status.error_code() == StatusCode::UNAUTHENTICATED) error = error.with({.reason = "UNAUTHENTICATED"});
  const std::string message = bounded(core::printable_lines(status.error_message()));
  return {status.error_code(), message, to_wire(error, status.error_code(), message).SerializeAsString()};
}

grpc::Status to_grpc(const core::Status& status, grpc::ServerContextBase& call) {
  if (status) return grpc::Status::OK;
  if (const auto delay_ms = core::details_of(status.error()).retry_delay_ms)
    call.AddTrailingMetadata(kRetryAfterKey, std::to_string(*delay_ms));
  return to_grpc(status.error());
}

grpc::Status to_grpc(const core::Status& status) {
  return status.has_value() ? grpc::Status::OK : to_grpc(status.error());
}

core::Error error_from_grpc(const grpc::Status& status) {
  assert(!status.ok());
  if (status.error_code() == StatusCode::UNIMPLEMENTED)
    return {ErrorCode::kFailedPrecondition,
            "the other side does not know this call: use the same release of Tessera on both"};
  return {code_from_grpc(status.error_code()), status.error_message(), details_from(status)};
}

std::optional<std::chrono::milliseconds> asked_wait(const grpc::Status& status,
                                                    const grpc::ClientContext& call) {
  if (status.error_code() != StatusCode::RESOURCE_EXHAUSTED) return std::nullopt;
  if (const auto details = details_from(status); details && details->retry_delay_ms)
    return std::chrono::milliseconds(*details->retry_delay_ms);
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
