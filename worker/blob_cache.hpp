// SPDX-License-Identifier: Apache-2.0
// A disk cache of scene files by SHA-256. Workers may share a folder. A file gets its name only when it is
// complete, and its bytes are checked each time it is requested, so that damage by a crash or a failing disk
// cannot reach an image. The folder never takes more than its limit: room is made before a download, whose
// file has its full size from the start. Thread-safe.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <set>
#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"
#include "proto/blob.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"

namespace tessera::worker {

inline constexpr std::uint64_t kDefaultCacheBytes = std::uint64_t{16} << 30;

// Whether the open file has the bytes of this digest. Reads all of it.
bool holds(const core::OpenFile& file, const proto::Digest& digest);

class BlobCache {
 public:
  // Creates the folder if it is missing. Errors name the folder and the reason: also if others may write to
  // it, or if it is another user's. Before each download the least recently used files, blobs and stored
  // scenes, are removed, so that at most `max_bytes` are in use.
  static core::Result<BlobCache> open(const std::string& folder,
                                      std::uint64_t max_bytes = kDefaultCacheBytes);

  const std::string& folder() const { return folder_; }
  std::uint64_t max_bytes() const { return max_bytes_; }
  // The bytes of all blobs and stored scenes in the folder, as far as they can be read.
  std::uint64_t used_bytes() const;
  // What was fetched from the coordinator; copies of this object count together.
  struct Fetched {
    std::atomic<std::uint64_t> files{0}, bytes{0};
  };
  const Fetched& fetched() const { return *fetched_; }
  // Whether a file in the folder is a blob or a stored scene.
  static bool is_file_name(const std::string& name);

  // The digests of files that are not removed, in hexadecimal.
  using InUse = std::set<std::string>;

  // The path of the blob's file, which is fetched from the coordinator if it is missing. Blocks; returns soon
  // after a stop. Errors are those of FetchBlob, CANCELLED after a stop, INTERNAL if the file cannot be
  // written, RESOURCE_EXHAUSTED if the files in use leave no room for it.
  core::Result<std::string> get(const proto::Digest& digest, const InUse& in_use,
                                v1::WorkerService::StubInterface& coordinator,
                                const std::stop_token& stop) const;

 private:
  BlobCache(std::string folder, std::uint64_t max_bytes)
      : folder_(std::move(folder)), max_bytes_(max_bytes) {}

  std::string path_of(const proto::Digest& digest) const;
  core::Status make_room(const InUse& in_use) const;
  core::Status download(const proto::Digest& digest, const std::string& path, const InUse& in_use,
                        v1::WorkerService::StubInterface& coordinator, const std::stop_token& stop) const;

  std::string folder_;
  std::uint64_t max_bytes_;
  std::shared_ptr<Fetched> fetched_ = std::make_shared<Fetched>();
};

}  // namespace tessera::worker
