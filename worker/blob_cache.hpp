// SPDX-License-Identifier: Apache-2.0
// A disk cache of scene files by SHA-256. Workers may share a folder. A file gets its name only when it is
// complete, and its bytes are checked each time it is requested, so that damage by a crash or a failing disk
// cannot reach an image. The folder never takes more than its limit: room is made before a download, whose
// file has its full size from the start. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "proto/blob.hpp"
#include "proto/segments.hpp"
#include "worker/blob_source.hpp"
#include "worker/partial_blob.hpp"

namespace tessera::worker {

inline constexpr std::uint64_t kDefaultCacheBytes = std::uint64_t{16} << 30;

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
  // What was fetched, and what of it other workers sent; what was sent to other workers. Copies of this
  // object count together.
  struct Traffic {
    std::atomic<std::uint64_t> files{0}, received_bytes{0}, peer_received_bytes{0}, peer_sent_bytes{0};
  };
  Traffic& traffic() const { return *traffic_; }
  // Whether a file in the folder is a blob or a stored scene.
  static bool is_file_name(const std::string& name);

  // The digests of files that are not removed, in hexadecimal.
  using InUse = std::set<std::string>;

  // The path of the blob's file, which is fetched from the source if it is missing. Blocks; returns soon
  // after a stop. Errors are those of the source, INTERNAL if the file cannot be written, RESOURCE_EXHAUSTED
  // if the files in use leave no room for it.
  core::Result<std::string> get(const proto::Digest& digest, const InUse& in_use, BlobSource& source,
                                const std::stop_token& stop) const;

  // A segment of a blob that is here or being fetched. In the second case, waits for it. Empty after the
  // timeout, and if there is no such blob. Not verified.
  std::optional<std::string> read_segment(const proto::Digest& digest, const proto::Segment& segment,
                                          std::chrono::milliseconds timeout) const;

 private:
  BlobCache(std::string folder, std::uint64_t max_bytes)
      : folder_(std::move(folder)), max_bytes_(max_bytes) {}

  std::string path_of(const proto::Digest& digest) const;
  core::Status make_room(const InUse& in_use) const;
  core::Status download(const proto::Digest& digest, const std::string& partial_path, const InUse& in_use,
                        BlobSource& source, const std::stop_token& stop) const;

  std::string folder_;
  std::uint64_t max_bytes_;
  std::shared_ptr<Traffic> traffic_ = std::make_shared<Traffic>();
  std::shared_ptr<PartialBlobs> partial_blobs_ = std::make_shared<PartialBlobs>();
};

}  // namespace tessera::worker
