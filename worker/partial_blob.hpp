// SPDX-License-Identifier: Apache-2.0
// Blobs that are being fetched: files of their full size, some segments of which are there already, also for
// others to read. Thread-safe.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "core/base/open_file.hpp"
#include "proto/blob.hpp"
#include "proto/segments.hpp"

namespace tessera::worker {

class PartialBlob {
 public:
  // Creates the file, which must not exist, with the full size of the blob. INTERNAL if that fails.
  static core::Result<std::shared_ptr<PartialBlob>> create(const std::string& path,
                                                           const proto::Digest& digest);

  const proto::Digest& digest() const { return digest_; }
  const std::string& path() const { return path_; }

  // INTERNAL with the reason if that fails.
  core::Status write(std::string_view bytes, std::uint64_t offset);
  // These are the correct bytes of the segment: others may have it.
  core::Status add(const proto::Segment& segment, std::string_view bytes);
  proto::SegmentSet held() const;
  // Forgets all segments.
  void clear();
  // Whether all bytes are there and match the digest. Reads them all.
  bool is_intact() const;

  // Waits for the segment, if it is not there. Empty after the timeout, or if it cannot be read.
  std::optional<std::string> read(const proto::Segment& segment, std::chrono::milliseconds timeout) const;

 private:
  PartialBlob(std::string path, const proto::Digest& digest, core::OpenFile file)
      : path_(std::move(path)),
        digest_(digest),
        file_(std::move(file)),
        held_(proto::segment_count(digest.size_bytes)) {}

  const std::string path_;
  const proto::Digest digest_;
  const core::OpenFile file_;
  mutable core::Mutex mutex_;
  mutable std::condition_variable added_;
  proto::SegmentSet held_ TESSERA_GUARDED_BY(mutex_);
};

// All partial blobs of this process, by digest; one of several with the same.
class PartialBlobs {
 public:
  // Lists a blob as long as it exists.
  class Listing {
   public:
    Listing(PartialBlobs& list, std::shared_ptr<PartialBlob> blob);
    ~Listing();
    Listing(const Listing&) = delete;
    Listing& operator=(const Listing&) = delete;

   private:
    PartialBlobs& list_;
    const std::shared_ptr<PartialBlob> blob_;
  };
  // Null if there is none.
  std::shared_ptr<const PartialBlob> find(const proto::Digest& digest) const;

 private:
  mutable core::Mutex mutex_;
  std::map<proto::Digest, std::shared_ptr<const PartialBlob>> blobs_ TESSERA_GUARDED_BY(mutex_);
};

// Whether the open file has the bytes of this digest. Reads all of it.
bool holds(const core::OpenFile& file, const proto::Digest& digest);

}  // namespace tessera::worker
