// SPDX-License-Identifier: Apache-2.0
// Conversions between core's errors and gRPC status codes. No other file converts them.
#pragma once

#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <optional>

#include "core/base/error.hpp"

namespace tessera::proto {

grpc::Status to_grpc(const core::Error& error);
// OK, or the error.
grpc::Status to_grpc(const core::Status& status);

// `status` must not be OK. Codes that core lacks become the nearest one.
core::Error error_from_grpc(const grpc::Status& status);
core::Status from_grpc(const grpc::Status& status);

// The key in the trailing metadata for the delay before a retry in milliseconds (gRFC A6). A
// RESOURCE_EXHAUSTED is temporary only if it has this.
inline constexpr const char* kRetryAfterKey = "grpc-retry-pushback-ms";

// The delay before a retry that a failed call asks for. Empty if there is none, or if the server forbids
// retries (any value that is no number of milliseconds).
std::optional<std::chrono::milliseconds> asked_wait(const grpc::Status& status,
                                                    const grpc::ClientContext& call);

// The error of a failed call. A temporary RESOURCE_EXHAUSTED becomes UNAVAILABLE.
core::Error error_from_grpc(const grpc::Status& status, const grpc::ClientContext& call);

}  // namespace tessera::proto
