// SPDX-License-Identifier: Apache-2.0
// Files known by their content, under FOLDER/ab/cdef... (the SHA-256 in hexadecimal).
//
// A blob becomes visible only when it is whole, checked against its digest and safe on disk. What an
// interrupted upload leaves lies in FOLDER/incoming and is removed at the next start. BlobStore is
// thread-safe, its copies are the same store; a writer or reader is for one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "proto/blob.hpp"
#include "server/store/file.hpp"

namespace tessera::store {

// Stands for the room that a blob takes, with whoever counts that. Let go of when the file is gone.
using Charge = std::shared_ptr<const void>;

// What a store has, as it comes and goes.
struct StoreIndex {
  struct Blob {
    proto::Digest digest;
    Charge charge;
  };
  std::mutex mutex;                   // also held while files get and lose their names
  std::map<std::string, Blob> blobs;  // guarded by mutex; by their SHA-256 in hexadecimal digits
};

// Takes one blob in pieces. Destroyed before commit() succeeded, it leaves nothing behind.
class BlobWriter {
 public:
  BlobWriter(BlobWriter&&) = default;
  BlobWriter& operator=(BlobWriter&&) = delete;
  ~BlobWriter();

  // INVALID_ARGUMENT as soon as there are more bytes than the digest says.
  core::Status append(std::string_view bytes);
  // DATA_LOSS if the bytes are not those of the digest. Blocks until they are on disk.
  core::Status commit();

 private:
  friend class BlobStore;
  struct Parts {
    proto::Digest digest;
    std::filesystem::path target, temporary;
    Charge charge;
    std::shared_ptr<StoreIndex> index;
    Fd fd;
  };
  explicit BlobWriter(Parts parts);
  core::Status take_name();

  Parts parts_;
  proto::Hasher hasher_;
};

// Gives one blob in pieces, and checks at the end that the file is still what it was.
class BlobReader {
 public:
  // The next bytes, at most `max_bytes`; empty at the end. DATA_LOSS instead of the last piece if the file's
  // content has changed on disk.
  core::Result<std::string> next(std::size_t max_bytes);

 private:
  friend class BlobStore;
  BlobReader(proto::Digest digest, std::filesystem::path path, Fd fd);

  proto::Digest digest_;
  std::filesystem::path path_;
  Fd fd_;
  proto::Hasher hasher_;
  std::uint64_t left_bytes_;
};

// A blob that was taken out of a store. Its file, and then its charge, go when this is destroyed, which can
// take a while.
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
  // Creates the folder if it is missing and removes what interrupted uploads left.
  static core::Result<BlobStore> open(const std::filesystem::path& folder);

  // For looking at a folder: creates, removes and counts nothing.
  static BlobStore look_at(const std::filesystem::path& folder) { return BlobStore(folder); }

  bool contains(const proto::Digest& digest) const;
  // Where the blob's file is or would be.
  std::filesystem::path path(const proto::Digest& digest) const;
  // The charge is kept until the blob is removed, or the writer is destroyed before commit() succeeded.
  core::Result<BlobWriter> write(const proto::Digest& digest, Charge charge = {}) const;
  // NOT_FOUND if it is not here, or of another size; INTERNAL if that cannot be told.
  core::Result<BlobReader> read(const proto::Digest& digest) const;
  // Reads it from beginning to end. NOT_FOUND, DATA_LOSS, or what the disk says; UNAVAILABLE as soon as a
  // stop is requested.
  core::Status check(const proto::Digest& digest, const std::stop_token& stop = {}) const;
  // The same, and counts it as used now.
  core::Status verify(const proto::Digest& digest, const std::stop_token& stop = {}) const;
  // Removes a blob's file, so that it can be uploaded anew. Nothing happens if there is none.
  void discard(const proto::Digest& digest) const { take_away(digest); }
  // The same at once, however large the file is: what takes time is left for when the answer is destroyed.
  RemovedBlob take_away(const proto::Digest& digest) const;

  // What was here when the store was opened, and what has come and not gone since. Asks no disk.
  std::vector<proto::Digest> stored() const;
  // Replaces the charge of a blob that is here.
  void charge(const proto::Digest& digest, Charge charge) const;
  // When the blob was uploaded or verified last. Nothing if that cannot be told.
  std::optional<std::filesystem::file_time_type> last_used(const proto::Digest& digest) const;
  // Every blob that is in the folder, whole or not: its size is that of its file.
  std::vector<proto::Digest> list() const;
  // Files that interrupted uploads left.
  std::vector<std::filesystem::path> interrupted() const;

 private:
  explicit BlobStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::filesystem::path folder_;
  std::shared_ptr<StoreIndex> index_ = std::make_shared<StoreIndex>();
};

}  // namespace tessera::store
