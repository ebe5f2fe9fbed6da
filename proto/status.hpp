// SPDX-License-Identifier: Apache-2.0
// The one place where core's errors become gRPC status codes, and back.
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

// `status` must not be OK. Codes that core lacks become the nearest one it has.
core::Error error_from_grpc(const grpc::Status& status);
core::Status from_grpc(const grpc::Status& status);

// Under this key the metadata after a call says in how many milliseconds it may be tried again (gRFC A6).
// Only a RESOURCE_EXHAUSTED with it passes by itself.
inline constexpr const char* kRetryAfterKey = "grpc-retry-pushback-ms";

// How long a call that has ended asks to wait before it is tried again. Nothing where it does not, or asks
// not to try again (any value that is no number of milliseconds).
std::optional<std::chrono::milliseconds> asked_wait(const grpc::Status& status,
                                                    const grpc::ClientContext& call);

// The error of a call that has ended: what is exhausted for a moment alone is UNAVAILABLE.
core::Error error_from_grpc(const grpc::Status& status, const grpc::ClientContext& call);

}  // namespace tessera::proto
