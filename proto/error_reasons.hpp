// SPDX-License-Identifier: Apache-2.0
// Reasons of errors (core::ErrorDetails::reason, google.rpc.ErrorInfo). They are part of the protocol:
// clients compare them, so none changes within v1. docs/protocol.md lists them. An error without one has the
// name of its status code as its reason.
#pragma once

namespace tessera::proto {

// INVALID_ARGUMENT: BadRequest names the field.
inline constexpr const char* kInvalidField = "INVALID_FIELD";
// FAILED_PRECONDITION: PreconditionFailure names the blobs.
inline constexpr const char* kMissingBlobs = "MISSING_BLOBS";
// RESOURCE_EXHAUSTED: more than this farm takes, which no repetition changes. The metadata names the option.
inline constexpr const char* kLimitExceeded = "LIMIT_EXCEEDED";
// RESOURCE_EXHAUSTED: what the caller has used must be given back first. QuotaFailure names the option.
inline constexpr const char* kQuotaExceeded = "QUOTA_EXCEEDED";
// RESOURCE_EXHAUSTED: it passes by itself. RetryInfo says when to call again.
inline constexpr const char* kTryLater = "TRY_LATER";

}  // namespace tessera::proto
