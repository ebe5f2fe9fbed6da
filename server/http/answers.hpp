// SPDX-License-Identifier: Apache-2.0
// Responses of the HTTP API: JSON, errors and empty ones. Pure functions.
#pragma once

#include <grpcpp/support/status.h>

#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.hpp"
#include "core/http/server.hpp"

namespace tessera::http_api {

using Json = nlohmann::ordered_json;

http::Response json_response(const Json& json, int status = 200);
// The same for an object that is text already, without the end of its line.
http::Response json_text_response(std::string text, int status = 200);
// {"error": {...}} with the status of HTTP that fits the code, and Retry-After if it passes by itself.
http::Response error_response(const core::Error& error);
// The same for a call that was not admitted, whose code may be one that core lacks.
http::Response rejection_response(const grpc::Status& status);
// 204.
http::Response no_content();
http::Response text_response(int status, const std::string& text);

// The code as a status of gRPC, for the count of calls.
grpc::Status grpc_status(const core::Error& error);

}  // namespace tessera::http_api
