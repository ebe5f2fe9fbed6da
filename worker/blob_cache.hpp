// SPDX-License-Identifier: Apache-2.0
// Blobs of scenes on this machine's disk, each under its SHA-256. Workers may share a folder. A file is
// visible under its name only when it is complete, and its bytes are checked again each time it is asked for,
// so that what a crash or a failing disk has left cannot reach a picture. Thread-safe.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "proto/blob.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"

namespace tessera::worker {

inline constexpr std::uint64_t kDefaultCacheBytes = std::uint64_t{16} << 30;

class BlobCache {
 public:
  // Creates the folder where it is missing. Errors name the folder and say why it cannot be used: also if
  // others may write to it, or it is another user's. After each transfer the files that were not used for
  // longest, blobs and kept scenes, are removed until no more than `max_bytes` are left, as
  // core::remove_least_used() does.
  static core::Result<BlobCache> open(const std::string& folder,
                                      std::uint64_t max_bytes = kDefaultCacheBytes);

  const std::string& folder() const { return folder_; }
  std::uint64_t max_bytes() const { return max_bytes_; }
  // Whether a file in the folder is a blob or belongs to the store of scenes beside them.
  static bool is_file_name(const std::string& name);

  // The path of the blob's file, fetched from the coordinator if it is not here yet. Blocks, but for no
  // longer than it takes to notice a stop. Errors are those of FetchBlob, CANCELLED after a stop, INTERNAL if
  // the file cannot be written.
  core::Result<std::string> get(const proto::Digest& digest, v1::WorkerService::StubInterface& coordinator,
                                const std::stop_token& stop) const;

 private:
  BlobCache(std::string folder, std::uint64_t max_bytes)
      : folder_(std::move(folder)), max_bytes_(max_bytes) {}

  std::string path_of(const proto::Digest& digest) const;
  core::Status download(const proto::Digest& digest, const std::string& path,
                        v1::WorkerService::StubInterface& coordinator, const std::stop_token& stop) const;

  std::string folder_;
  std::uint64_t max_bytes_;
};

}  // namespace tessera::worker
