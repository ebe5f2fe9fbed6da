// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/blob_calls.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>

#include "proto/blob.hpp"
#include "proto/status.hpp"
#include "proto/text.hpp"
#include "server/auth/auth_interceptor.hpp"
#include "server/blobs/admission.hpp"

namespace tessera::rpc {

namespace {

core::Result<blobs::BlobWriter> open_writer(server::Coordinator& coordinator, const std::string& caller,
                                            const proto::Digest& digest) {
  auto writer = coordinator.files().write(caller, digest);
  if (writer || writer.error().code != core::ErrorCode::kResourceExhausted) return writer;
  return coordinator.files().write_making_room(caller, digest);
}

core::Status store_one(server::Coordinator& coordinator, const std::string& caller,
                       const server::Limits& limits, const v1::BatchUploadBlobsRequest::Blob& blob) {
  const auto digest = proto::from_proto(blob.digest());
  if (!digest) return core::fail(digest.error());
  if (auto fits = blobs::check_blob_size(digest->size_bytes, limits); !fits) return fits;
  const auto use = coordinator.files().use(caller, *digest);
  if (!use) return core::fail(server::temporary(use.error(), auth::kTryAgainAfter));
  if (coordinator.blobs().contains(*digest)) return {};
  auto writer = open_writer(coordinator, caller, *digest);
  if (!writer) return core::fail(writer.error());
  if (auto appended = writer->append(blob.data()); !appended) return appended;
  return writer->commit();
}

}  // namespace

core::Status find_missing(server::Coordinator& coordinator, const std::string& caller,
                          const v1::FindMissingBlobsRequest& request,
                          v1::FindMissingBlobsResponse& response) {
  std::set<proto::Digest> files;
  for (const v1::Digest& message : request.digests()) {
    const auto digest = proto::from_proto(message);
    if (!digest) return core::fail(digest.error());
    files.insert(*digest);
  }
  const auto claimed = coordinator.files().claim(caller, {files.begin(), files.end()});
  if (!claimed) return core::fail(server::temporary(claimed.error(), auth::kTryAgainAfter));
  for (const proto::Digest& file : files) {
    if (!coordinator.blobs().contains(file)) *response.add_missing() = proto::to_proto(file);
  }
  return {};
}

core::Status upload_batch(server::Coordinator& coordinator, const std::string& caller,
                          const server::Limits& limits, const v1::BatchUploadBlobsRequest& request,
                          v1::BatchUploadBlobsResponse& response) {
  std::size_t bytes = 0;
  for (const auto& blob : request.blobs()) bytes += blob.data().size();
  if (bytes > kMaxBatchBytes)
    return core::fail(proto::invalid_field(
        "blobs", fmt::format("a batch may have {} bytes of data, got {}", kMaxBatchBytes, bytes)));
  for (const auto& blob : request.blobs()) {
    const grpc::Status stored = proto::to_grpc(store_one(coordinator, caller, limits, blob));
    auto& result = *response.add_results();
    *result.mutable_digest() = blob.digest();
    result.set_code(stored.error_code());
    result.set_message(stored.error_message());
  }
  return {};
}

core::Status get_upload(server::Coordinator& coordinator, const std::string& caller,
                        const v1::GetUploadRequest& request, v1::GetUploadResponse& response) {
  const auto digest = proto::from_proto(request.digest());
  if (!digest) return core::fail(digest.error());
  response.set_is_stored(coordinator.blobs().contains(*digest));
  response.set_committed_bytes(response.is_stored() ? digest->size_bytes
                                                    : coordinator.files().partial_bytes(caller, *digest));
  return {};
}

}  // namespace tessera::rpc
