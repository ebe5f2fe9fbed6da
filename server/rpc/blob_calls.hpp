// SPDX-License-Identifier: Apache-2.0
// Unary calls for blobs. Stateless; thread-safe. They block for the disk.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "server/coordinator.hpp"
#include "server/limits.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::rpc {

// What a batch may hold.
inline constexpr std::size_t kMaxBatchBlobs = 1024;
inline constexpr std::size_t kMaxBatchBytes = std::size_t{1} << 20;

// Claims the blobs of the request for the caller's submission, and names those that are missing. Blobs in the
// store are claimed before they are looked up, so that they are still there when the missing ones have been
// uploaded.
core::Status find_missing(server::Coordinator& coordinator, const std::string& caller,
                          const v1::FindMissingBlobsRequest& request, v1::FindMissingBlobsResponse& response);

// Stores each blob of the request. INVALID_ARGUMENT if there is more data than a batch may hold; other errors
// are those of single blobs, in the response.
core::Status upload_batch(server::Coordinator& coordinator, const std::string& caller,
                          const server::Limits& limits, const v1::BatchUploadBlobsRequest& request,
                          v1::BatchUploadBlobsResponse& response);

// How much of a blob is here.
core::Status get_upload(server::Coordinator& coordinator, const std::string& caller,
                        const v1::GetUploadRequest& request, v1::GetUploadResponse& response);

}  // namespace tessera::rpc
