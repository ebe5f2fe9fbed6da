// SPDX-License-Identifier: Apache-2.0
// Conversions between core's errors and gRPC statuses. No other file converts them.
//
// A status has the error's details (core::ErrorDetails) as google.rpc.Status in the trailing metadata
// grpc-status-details-bin: ErrorInfo always, with the domain "tessera"; BadRequest, PreconditionFailure,
// QuotaFailure and RetryInfo where they apply. gRPC bounds the metadata of a call, so long messages are cut.
#pragma once

#include <grpcpp/client_context.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <cstddef>
#include <optional>

#include "core/base/error.hpp"

namespace tessera::proto {

grpc::Status to_grpc(const core::Error& error);
// For a call on a server: adds kRetryAfterKey to its trailing metadata if the error passes by itself.
grpc::Status to_grpc(const core::Status& status, grpc::ServerContextBase& call);
// OK, or the error.
grpc::Status to_grpc(const core::Status& status);

// The same status with details, for codes that core lacks.
grpc::Status with_details(const grpc::Status& status);

// The longest message of a status in bytes, and the most missing things that it names.
inline constexpr std::size_t kMaxStatusBytes = 1200;
inline constexpr std::size_t kMaxMissing = 20;

// `status` must not be OK. Codes that core lacks become the nearest one.
core::Error error_from_grpc(const grpc::Status& status);
core::Status from_grpc(const grpc::Status& status);

// The key in the trailing metadata for the delay before a retry in milliseconds (gRFC A6), for clients that
// do not read details.
inline constexpr const char* kRetryAfterKey = "grpc-retry-pushback-ms";

// The delay before a retry that a failed call with RESOURCE_EXHAUSTED asks for, by RetryInfo or by
// kRetryAfterKey. Empty if there is none, or if the server forbids retries (any value that is no number of
// milliseconds).
std::optional<std::chrono::milliseconds> asked_wait(const grpc::Status& status,
                                                    const grpc::ClientContext& call);

// The error of a failed call. A temporary RESOURCE_EXHAUSTED becomes UNAVAILABLE.
core::Error error_from_grpc(const grpc::Status& status, const grpc::ClientContext& call);

}  // namespace tessera::proto
