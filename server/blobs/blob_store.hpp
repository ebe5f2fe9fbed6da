// SPDX-License-Identifier: Apache-2.0
// A content-addressed store of files, FOLDER/ab/cdef... (the SHA-256 in hexadecimal digits).
//
// A blob becomes visible only when it is complete, checked against its digest and synced to disk. Incomplete
// uploads lie in FOLDER/incoming and are removed at the next start. BlobStore is thread-safe, and its copies
// share one store; a writer or reader is for one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "proto/blob.hpp"
#include "server/base/file.hpp"

namespace tessera::blobs {

// The quota charge for a blob. It is released after the file is removed.
using Charge = std::shared_ptr<const void>;

// The index of the blobs in a store.
struct StoreIndex {
  struct Blob {
    proto::Digest digest;
    Charge charge;
  };
  core::Mutex mutex;  // also held while files are renamed or removed
  // The key is the SHA-256 in hexadecimal digits.
  std::map<std::string, Blob> blobs TESSERA_GUARDED_BY(mutex);
};

// Writes one blob in chunks. If it is destroyed before commit() succeeded, it removes what it wrote.
class BlobWriter {
 public:
  BlobWriter(BlobWriter&&) = default;
  BlobWriter& operator=(BlobWriter&&) = delete;
  ~BlobWriter();

  // INVALID_ARGUMENT as soon as there are more bytes than the digest says.
  core::Status append(std::string_view bytes);
  // DATA_LOSS if the bytes do not match the digest. Blocks until they are synced to disk.
  core::Status commit();
  // For a blob of which only the size was known: the digest of all of its bytes. Call it once, before
  // commit(). DATA_LOSS if some are missing.
  core::Result<proto::Digest> name_by_content();

  const proto::Digest& digest() const { return parts_.digest; }
  // The bytes that append() has taken.
  std::uint64_t written_bytes() const { return hasher_.size_bytes(); }
  // Whether all bytes were received.
  bool is_whole() const { return written_bytes() == parts_.digest.size_bytes; }
  // Whether bytes are missing, and those that were received are written.
  bool can_be_continued() const { return parts_.fd && !failed_ && !is_whole(); }

 private:
  friend class BlobStore;
  struct Parts {
    proto::Digest digest;
    std::filesystem::path folder, temporary;  // of the store, and the file
    Charge charge;
    std::shared_ptr<StoreIndex> index;
    base::Fd fd;
  };
  explicit BlobWriter(Parts parts);
  core::Status take_name();

  Parts parts_;
  proto::Hasher hasher_;
  bool failed_ = false;  // a write
  bool is_named_by_content_ = false;
};

// Reads one blob, or a part of it, in chunks. Checks the digest at the end of a whole blob.
class BlobReader {
 public:
  // Limits it to these bytes of the blob. Call it before next(). INTERNAL if the file cannot be read there.
  core::Status limit_to(std::uint64_t offset_bytes, std::uint64_t size_bytes);
  // The next bytes, at most `max_bytes`; empty at the end. DATA_LOSS instead of the last chunk if the file
  // has changed on disk.
  core::Result<std::string> next(std::size_t max_bytes);
  std::uint64_t left_bytes() const { return left_bytes_; }
  // The digest of what was read. Valid when nothing is left.
  const proto::Digest& read_digest() const { return read_digest_; }

 private:
  friend class BlobStore;
  BlobReader(proto::Digest digest, std::filesystem::path path, base::Fd fd);

  proto::Digest digest_;
  std::filesystem::path path_;
  base::Fd fd_;
  proto::Hasher hasher_;
  std::uint64_t left_bytes_;
  bool is_part_ = false;
  proto::Digest read_digest_;
};

// A blob that was removed from a store. The destructor deletes its file, which can take a while, and then
// releases its charge.
class RemovedBlob {
 public:
  RemovedBlob(RemovedBlob&&) = default;
  RemovedBlob& operator=(RemovedBlob&&) = delete;
  ~RemovedBlob();

 private:
  friend class BlobStore;
  RemovedBlob(std::filesystem::path file, Charge charge);

  std::filesystem::path file_;  // empty when moved from
  Charge charge_;
};

class BlobStore {
 public:
  // Creates the folder if it is missing, and removes incomplete uploads.
  static core::Result<BlobStore> open(const std::filesystem::path& folder);

  // Opens a folder for reading: creates, removes and counts nothing.
  static BlobStore look_at(const std::filesystem::path& folder) { return BlobStore(folder); }

  bool contains(const proto::Digest& digest) const;
  // The path of the blob's file, whether it exists or not.
  std::filesystem::path path(const proto::Digest& digest) const;
  // The charge is kept until the blob is removed, or the writer is destroyed before commit() succeeded.
  core::Result<BlobWriter> write(const proto::Digest& digest, Charge charge = {}) const;
  // NOT_FOUND if the blob is not in the store, or has another size; INTERNAL if that cannot be checked.
  core::Result<BlobReader> read(const proto::Digest& digest) const;
  // Reads the whole blob and checks it. NOT_FOUND, DATA_LOSS, or the error of the disk; UNAVAILABLE as soon
  // as a stop is requested.
  core::Status check(const proto::Digest& digest, const std::stop_token& stop = {}) const;
  // The same, and marks it as used now.
  core::Status verify(const proto::Digest& digest, const std::stop_token& stop = {}) const;
  // Removes a blob's file, so that it can be uploaded again. Does nothing if there is none.
  void discard(const proto::Digest& digest) const { take_away(digest); }
  // The same without the time for deleting a large file, which the destructor of the returned object takes.
  RemovedBlob take_away(const proto::Digest& digest) const;

  // The blobs in the index. Does not access the disk.
  std::vector<proto::Digest> stored() const;
  // Replaces the charge of a blob in the store.
  void charge(const proto::Digest& digest, Charge charge) const;
  // When the blob was last uploaded or verified. Empty if that cannot be read.
  std::optional<std::filesystem::file_time_type> last_used(const proto::Digest& digest) const;
  // Every blob in the folder, intact or not; the sizes are those of the files.
  std::vector<proto::Digest> list() const;
  // The files of incomplete uploads.
  std::vector<std::filesystem::path> interrupted() const;

 private:
  explicit BlobStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::filesystem::path folder_;
  std::shared_ptr<StoreIndex> index_ = std::make_shared<StoreIndex>();
};

}  // namespace tessera::blobs
