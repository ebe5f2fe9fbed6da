// SPDX-License-Identifier: Apache-2.0
#include "server/http/answers.hpp"

#include <utility>

#include "proto/error_reasons.hpp"
#include "proto/json.hpp"
#include "proto/status.hpp"

namespace tessera::http_api {

namespace {

using core::ErrorCode;

int refusal_status(const core::ErrorDetails& details) {
  return details.reason == proto::kLimitExceeded ? 413 : 429;
}

int status_of(const core::Error& error) {
  const core::ErrorDetails details = core::details_of(error);
  switch (error.code) {
    case ErrorCode::kInvalidArgument:
    case ErrorCode::kOutOfRange:
      return 400;
    case ErrorCode::kNotFound:
      return 404;
    case ErrorCode::kAlreadyExists:
      return 409;
    case ErrorCode::kPermissionDenied:
      return 403;
    case ErrorCode::kResourceExhausted:
      return refusal_status(details);
    case ErrorCode::kFailedPrecondition:
      return details.missing.empty() ? 409 : 412;
    case ErrorCode::kCancelled:
    case ErrorCode::kUnavailable:
      return 503;
    case ErrorCode::kDeadlineExceeded:
      return 504;
    case ErrorCode::kDataLoss:
    case ErrorCode::kInternal:
      return 500;
  }
  return 500;
}

}  // namespace

http::Response json_response(const Json& json, int status) {
  return json_text_response(proto::to_line(json), status);
}

// What a farm says may change with every request, and is nobody else's.
http::Response json_text_response(std::string text, int status) {
  return {.status = status,
          .headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}},
          .body = std::move(text) + "\n"};
}

http::Response error_response(const core::Error& error) {
  http::Response response = json_response({{"error", proto::error_to_json(error)}}, status_of(error));
  if (const auto delay_ms = core::details_of(error).retry_delay_ms)
    response.headers.emplace_back("Retry-After", std::to_string((*delay_ms + 999) / 1000));
  return response;
}

http::Response rejection_response(const grpc::Status& status) {
  if (status.error_code() != grpc::StatusCode::UNAUTHENTICATED)
    return error_response(proto::error_from_grpc(status));
  http::Response response =
      json_response({{"error", {{"code", "UNAUTHENTICATED"}, {"message", status.error_message()}}}}, 401);
  response.headers.emplace_back("WWW-Authenticate", "Bearer");
  return response;
}

http::Response no_content() {
  return {.status = 204, .headers = {{"Cache-Control", "no-store"}}};
}

http::Response text_response(int status, const std::string& text) {
  return {.status = status,
          .headers = {{"Content-Type", "text/plain; charset=utf-8"}, {"Cache-Control", "no-store"}},
          .body = text + "\n"};
}

grpc::Status grpc_status(const core::Error& error) {
  return proto::to_grpc(error);
}

}  // namespace tessera::http_api
