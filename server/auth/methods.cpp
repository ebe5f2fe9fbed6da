// SPDX-License-Identifier: Apache-2.0
#include "server/auth/methods.hpp"

#include <cstdint>
#include <utility>

#include "core/common/log.hpp"
#include "proto/blob.hpp"

namespace tessera::auth {

namespace {

// For messages of an id and a few numbers and texts.
constexpr std::size_t kSmallBytes = 4 << 10;
const ShapeLimits kSmall{64};

// A worker holds four leases of about thirty items each, and reports more while some of them have ended.
constexpr std::size_t kSynchronizeBytes = 256 << 10;
const ShapeLimits kSynchronize{1 << 14,
                               {{"tessera.v1.SynchronizeRequest.held", 16},
                                {"tessera.v1.Lease.items", 256},
                                {"tessera.v1.SynchronizeRequest.known_job_ids", 4096},
                                {"tessera.v1.SynchronizeRequest.fetching_job_ids", 256}}};
const ShapeLimits kSubmitResult{
    1 << 16,
    {{"tessera.v1.SubmitResultRequest.items", 1024}, {"tessera.v1.SubmitResultRequest.held_lease_ids", 64}}};

// A file of a bundle has five fields: itself, its path, its digest, and the two fields of the digest.
constexpr std::uint64_t kFieldsPerFile = 8, kFieldsBesidesFiles = 256;

// A chunk of a blob and its digest. UploadStream refuses chunks that are slightly too large with a better
// message.
constexpr std::size_t kUploadBytes = 2 * proto::kMaxChunkBytes;

// It may have a certificate, a bit for each segment of a blob, and the ids of workers.
constexpr std::size_t kFetchBytes = 64 << 10;
const ShapeLimits kFetch{256, {{"tessera.v1.SegmentRequest.excluded_worker_ids", 64}}};

// A batch of small blobs, of five fields each.
const ShapeLimits kBatch{1 << 13, {{"tessera.v1.BatchUploadBlobsRequest.blobs", 1024}}};

// Tiles of an image, of nine fields each.
constexpr std::size_t kExtensionBytes = 64 << 10;
const ShapeLimits kExtension{1 << 14, {{"tessera.v1.ExtendJobRequest.tiles", 1024}}};

// A list may be filtered by labels.
constexpr std::size_t kListBytes = 16 << 10;
const ShapeLimits kList{256, {{"tessera.v1.ListJobsRequest.labels", 32}}};

ShapeLimits files(std::string_view field, const server::Limits& limits) {
  return {kFieldsPerFile * limits.bundle_files + kFieldsBesidesFiles,
          {{field, limits.bundle_files, "--max-bundle-files"}}};
}

ShapeLimits submission(const server::Limits& limits) {
  ShapeLimits shape = files("tessera.v1.Bundle.assets", limits);
  shape.max_fields += limits.images;
  shape.fields.push_back({"tessera.v1.SubmitJobRequest.frames", limits.images, "--max-images"});
  return shape;
}

}  // namespace

Methods::Methods(const server::Limits& limits) {
  const std::size_t large_bytes = static_cast<std::size_t>(limits.message_mib) * server::kMib;
  const auto add = [&](const std::string& service, const std::string& name, Role role, std::size_t max_bytes,
                       ShapeLimits shape) {
    const std::string path = "/tessera.v1." + service + "/" + name;
    methods_.emplace(path, Method{path, role, max_bytes, std::move(shape)});
  };
  for (const char* const name :
       {"GetJob", "WatchJob", "WatchFarm", "WatchTiles", "GetImage", "ListWorkers", "GetServerInfo"})
    add("RenderService", name, Role::kWatch, kSmallBytes, kSmall);
  add("RenderService", "ListJobs", Role::kWatch, kListBytes, kList);
  for (const char* const name : {"CancelJob", "PauseJob", "ResumeJob", "UpdateJob", "DeleteJob", "GetUpload"})
    add("RenderService", name, Role::kSubmit, kSmallBytes, kSmall);
  add("RenderService", "BatchUploadBlobs", Role::kSubmit, kUploadBytes, kBatch);
  add("RenderService", "FindMissingBlobs", Role::kSubmit, large_bytes,
      files("tessera.v1.FindMissingBlobsRequest.digests", limits));
  add("RenderService", "UploadBlob", Role::kSubmit, kUploadBytes, kSmall);
  add("RenderService", "SubmitJob", Role::kSubmit, large_bytes, submission(limits));
  add("RenderService", "ExtendJob", Role::kSubmit, kExtensionBytes, kExtension);
  add("WorkerService", "Synchronize", Role::kWork, kSynchronizeBytes, kSynchronize);
  add("WorkerService", "SubmitResult", Role::kWork, large_bytes, kSubmitResult);
  add("WorkerService", "FetchBlob", Role::kWork, kFetchBytes, kFetch);
  for (const char* const name : {"ListQuarantine", "LiftQuarantine", "DrainWorker"})
    add("AdminService", name, Role::kAdmin, kSmallBytes, kSmall);
}

const Method& Methods::at(const std::string& path) const {
  if (const auto found = methods_.find(path); found != methods_.end()) return found->second;
  common::abort_with("the table of methods lacks " + path);
}

}  // namespace tessera::auth
