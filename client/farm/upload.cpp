// SPDX-License-Identifier: Apache-2.0
#include "client/farm/upload.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <utility>

#include "core/scene/loader/asset_source.hpp"
#include "proto/blob.hpp"
#include "proto/status.hpp"

namespace tessera::client {
namespace {

using core::ErrorCode;
using core::fail;

// A batch may hold so much (render_service.proto). Larger files than kMaxSmallBytes have streams of their
// own.
constexpr std::uint64_t kMaxSmallBytes = 64 << 10;
constexpr std::uint64_t kMaxBatchBytes = 1 << 20;
constexpr int kMaxBatchBlobs = 1024;

// More than a client sends before the coordinator checks the data (proto/channel.cpp).
constexpr std::uint64_t kSurelyTakenBytes = std::uint64_t{2} << 20;

core::Error has_changed(const std::string& name) {
  return {ErrorCode::kFailedPrecondition,
          fmt::format("'{}' has changed since the scene was read: submit it again", name)};
}

bool is_scene_text(const LocalBundle& local, const std::string& name) {
  return local.scene_text && name == local.bundle.scene_path();
}

std::unique_ptr<std::istream> open_file(const LocalBundle& local, const std::string& name) {
  if (is_scene_text(local, name)) return std::make_unique<std::istringstream>(*local.scene_text);
  return std::make_unique<std::ifstream>(
      std::filesystem::path(local.folder.empty() ? "." : local.folder) / local.paths.at(name),
      std::ios::binary);
}

// A file of the bundle that is read in chunks.
class FileReader {
 public:
  FileReader(const LocalBundle& local, const std::string& name) : file_(open_file(local, name)) {}

  void seek(std::uint64_t offset_bytes) { file_->seekg(static_cast<std::streamoff>(offset_bytes)); }
  // The next bytes, fewer only at the end of the file or where it cannot be read.
  std::string next(std::uint64_t max_bytes) {
    std::string bytes(std::min<std::uint64_t>(max_bytes, proto::kChunkBytes), '\0');
    file_->read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file_->gcount())));
    return bytes;
  }

 private:
  std::unique_ptr<std::istream> file_;
};

proto::Digest digest_of_file(const LocalBundle& local, const std::string& name) {
  FileReader file(local, name);
  proto::Hasher hasher;
  for (std::string bytes = file.next(proto::kChunkBytes); !bytes.empty();
       bytes = file.next(proto::kChunkBytes))
    hasher.update(bytes);
  return hasher.finish();
}

struct MissingFile {
  std::string name;
  proto::Digest digest;
};

// The files of the bundle with these SHA-256, each once.
std::vector<MissingFile> files_of(const LocalBundle& local, const std::set<std::string>& missing) {
  std::vector<MissingFile> files;
  std::set<std::string> left = missing;
  for (const v1::Bundle::Asset& asset : local.bundle.assets()) {
    const auto digest = proto::from_proto(asset.digest());
    if (digest && left.erase(asset.digest().sha256()) > 0) files.push_back({asset.path(), *digest});
  }
  return files;
}

// Sends the bytes from an offset on. Sets `progress` if the coordinator has surely taken some of them.
grpc::Status stream_file(Farm& farm, const LocalBundle& local, const MissingFile& file,
                         std::uint64_t offset_bytes, grpc::ClientContext& context, bool& progress) {
  v1::UploadBlobResponse response;
  const auto stream = farm.stub().UploadBlob(&context, &response);
  FileReader reader(local, file.name);
  reader.seek(offset_bytes);
  v1::UploadBlobRequest request;
  request.set_offset_bytes(offset_bytes);
  *request.mutable_chunk()->mutable_digest() = proto::to_proto(file.digest);
  std::uint64_t at = offset_bytes;
  while (at < file.digest.size_bytes) {
    std::string bytes = reader.next(file.digest.size_bytes - at);
    at += bytes.size();
    const bool is_end = bytes.empty();  // the file has become shorter
    request.mutable_chunk()->set_data(std::move(bytes));
    if (is_end || !stream->Write(request)) break;
    request.Clear();
  }
  stream->WritesDone();
  grpc::Status status = stream->Finish();
  progress = progress || status.ok() || at - offset_bytes > kSurelyTakenBytes;
  return status;
}

core::Status upload_large(Farm& farm, const LocalBundle& local, const MissingFile& file, bool& progress) {
  v1::GetUploadRequest asked;
  *asked.mutable_digest() = proto::to_proto(file.digest);
  const auto begun = farm.call(&Farm::Stub::GetUpload, asked);
  if (!begun) return fail(begun.error());
  if (begun->is_stored()) return {};
  std::uint64_t offset_bytes = begun->committed_bytes();
  while (true) {
    grpc::ClientContext context;
    const grpc::Status status = stream_file(farm, local, file, offset_bytes, context, progress);
    if (status.ok()) return {};
    // What had come was removed meanwhile.
    if (status.error_code() == grpc::StatusCode::OUT_OF_RANGE && std::exchange(offset_bytes, 0) > 0) continue;
    const bool is_wrong_file = status.error_code() == grpc::StatusCode::DATA_LOSS ||
                               status.error_code() == grpc::StatusCode::INVALID_ARGUMENT;
    if (is_wrong_file && digest_of_file(local, file.name) != file.digest) return fail(has_changed(file.name));
    return fail(farm.explain(status, context).within(fmt::format("uploading '{}'", file.name)));
  }
}

// Adds the file to the batch.
core::Status add_small(const LocalBundle& local, const MissingFile& file,
                       v1::BatchUploadBlobsRequest& batch) {
  core::FolderAssets files(local.folder);
  auto bytes = is_scene_text(local, file.name) ? core::Result<std::string>(*local.scene_text)
                                               : files.read(local.paths.at(file.name));
  if (!bytes) return fail(bytes.error());
  if (proto::digest_of(*bytes) != file.digest) return fail(has_changed(file.name));
  v1::BatchUploadBlobsRequest::Blob& blob = *batch.add_blobs();
  *blob.mutable_digest() = proto::to_proto(file.digest);
  *blob.mutable_data() = *std::move(bytes);
  return {};
}

core::Status send_batch(Farm& farm, const v1::BatchUploadBlobsRequest& batch, bool& progress) {
  if (batch.blobs_size() == 0) return {};
  const auto response = farm.call(&Farm::Stub::BatchUploadBlobs, batch);
  if (!response) return fail(response.error());
  progress = true;
  for (const v1::BatchUploadBlobsResponse::Result& result : response->results()) {
    const grpc::Status status(static_cast<grpc::StatusCode>(result.code()), result.message());
    if (!status.ok()) return fail(proto::error_from_grpc(status).within("uploading a file"));
  }
  return {};
}

core::Status upload_small(Farm& farm, const LocalBundle& local, const std::vector<MissingFile>& files,
                          bool& progress) {
  v1::BatchUploadBlobsRequest batch;
  std::uint64_t batch_bytes = 0;
  for (const MissingFile& file : files) {
    if (file.digest.size_bytes > kMaxSmallBytes) continue;
    if (batch_bytes + file.digest.size_bytes > kMaxBatchBytes || batch.blobs_size() == kMaxBatchBlobs) {
      if (core::Status sent = send_batch(farm, batch, progress); !sent) return sent;
      batch.Clear();
      batch_bytes = 0;
    }
    if (core::Status added = add_small(local, file, batch); !added) return added;
    batch_bytes += file.digest.size_bytes;
  }
  return send_batch(farm, batch, progress);
}

core::Status upload_files(Farm& farm, const LocalBundle& local, const std::vector<MissingFile>& files,
                          bool& progress) {
  if (core::Status sent = upload_small(farm, local, files, progress); !sent) return sent;
  for (const MissingFile& file : files) {
    if (file.digest.size_bytes <= kMaxSmallBytes) continue;
    if (core::Status sent = upload_large(farm, local, file, progress); !sent) return sent;
  }
  return {};
}

// Returns the SHA-256 of missing files. From now on the coordinator keeps the files of the bundle that it
// has.
core::Result<std::set<std::string>> find_missing(Farm& farm, const v1::Bundle& bundle) {
  v1::FindMissingBlobsRequest request;
  for (const v1::Bundle::Asset& asset : bundle.assets()) *request.add_digests() = asset.digest();
  const auto response = farm.call(&Farm::Stub::FindMissingBlobs, request);
  if (!response) return fail(response.error());
  std::set<std::string> missing;
  for (const v1::Digest& digest : response->missing()) missing.insert(digest.sha256());
  return missing;
}

}  // namespace

core::Status upload_missing(Farm& farm, const LocalBundle& local) {
  const auto done = patiently<bool>(farm, [&](bool& progress) -> core::Result<bool> {
    // Asks at each attempt, because a restarted coordinator keeps files only for clients that ask again.
    const auto missing = find_missing(farm, local.bundle);
    if (!missing) return fail(missing.error());
    if (core::Status sent = upload_files(farm, local, files_of(local, *missing), progress); !sent)
      return fail(sent.error());
    return true;
  });
  return done ? core::Status{} : fail(done.error());
}

core::Status upload_named(Farm& farm, const LocalBundle& local, const std::vector<std::string>& names) {
  std::set<std::string> missing;
  for (const std::string& name : names)
    if (const auto digest = proto::digest_from_name(name)) missing.insert(proto::to_proto(*digest).sha256());
  const std::vector<MissingFile> files = files_of(local, missing);
  if (names.size() >= proto::kMaxMissing || files.size() != names.size()) return upload_missing(farm, local);
  bool progress = false;
  const core::Status sent = upload_files(farm, local, files, progress);
  if (sent || !proto::is_transient(sent.error().code)) return sent;
  return upload_missing(farm, local);
}

}  // namespace tessera::client
