// The one place where core's errors become gRPC status codes, and back.
#pragma once

#include <grpcpp/support/status.h>

#include "core/base/error.hpp"

namespace tessera::proto {

grpc::Status to_grpc(const core::Error& error);
// OK, or the error.
grpc::Status to_grpc(const core::Status& status);

// `status` must not be OK. Codes that core lacks become the nearest one it has.
core::Error error_from_grpc(const grpc::Status& status);
core::Status from_grpc(const grpc::Status& status);

}  // namespace tessera::proto
