// Files known by their content, under FOLDER/ab/cdef... (the SHA-256 in hexadecimal).
//
// A blob becomes visible only when it is whole, checked against its digest and safe on disk. What an
// interrupted upload leaves lies in FOLDER/incoming and is removed at the next start. BlobStore is
// thread-safe, its copies are the same store; a writer or reader is for one thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "proto/blob.hpp"
#include "server/store/file.hpp"

namespace tessera::store {

// The bytes in a store, counted as they come and go.
struct StoreUsage {
  std::mutex mutex;  // also held while files get and lose their names, so that each is counted once
  std::uint64_t stored_bytes = 0, incoming_bytes = 0;  // guarded by mutex
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
  BlobWriter(proto::Digest digest, std::filesystem::path target, std::filesystem::path temporary, Fd fd,
             std::shared_ptr<StoreUsage> usage);
  core::Status take_name();

  proto::Digest digest_;
  std::filesystem::path target_, temporary_;
  Fd fd_;
  proto::Hasher hasher_;
  std::shared_ptr<StoreUsage> usage_;  // null when moved from
  std::uint64_t counted_bytes_ = 0;    // of usage_->incoming_bytes
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

class BlobStore {
 public:
  // Creates the folder if it is missing and removes what interrupted uploads left.
  static core::Result<BlobStore> open(const std::filesystem::path& folder);

  // For looking at a folder: creates, removes and counts nothing.
  static BlobStore look_at(const std::filesystem::path& folder) { return BlobStore(folder); }

  bool contains(const proto::Digest& digest) const;
  // Where the blob's file is or would be.
  std::filesystem::path path(const proto::Digest& digest) const;
  core::Result<BlobWriter> write(const proto::Digest& digest) const;
  // NOT_FOUND if it is not here, or of another size; INTERNAL if that cannot be told.
  core::Result<BlobReader> read(const proto::Digest& digest) const;
  // Reads it from beginning to end. NOT_FOUND, DATA_LOSS, or what the disk says; UNAVAILABLE as soon as a
  // stop is requested.
  core::Status check(const proto::Digest& digest, const std::stop_token& stop = {}) const;
  // The same, and counts it as used now.
  core::Status verify(const proto::Digest& digest, const std::stop_token& stop = {}) const;
  // Removes a blob's file, so that it can be uploaded anew. Nothing happens if there is none.
  void discard(const proto::Digest& digest) const;

  // Of all blobs that are here, as when the store was opened and what has come and gone since; and what of
  // others has come so far.
  std::uint64_t used_bytes() const;
  // Every blob that is here, whole or not: its size is that of its file.
  std::vector<proto::Digest> list() const;
  // Files that interrupted uploads left.
  std::vector<std::filesystem::path> interrupted() const;

  // Removes every blob that was neither uploaded nor verified within `unused_for`, but for those of which
  // `keep` has the SHA-256 in hexadecimal digits. Answers with how many that were.
  std::size_t collect(const std::set<std::string>& keep, std::chrono::seconds unused_for) const;

 private:
  explicit BlobStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Removes a blob's file. Whether there was one.
  bool remove(const std::filesystem::path& blob) const;

  std::filesystem::path folder_;
  std::shared_ptr<StoreUsage> usage_ = std::make_shared<StoreUsage>();
};

}  // namespace tessera::store
