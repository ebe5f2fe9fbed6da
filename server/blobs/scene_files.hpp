// SPDX-License-Identifier: Apache-2.0
// The files of scenes: their users, the room that they take, and which of them are removed when there is none
// left.
//
// A file takes room from the start of its upload. It counts toward the share of the uploader
// (fair_share.hpp), and once a job names it, toward that of the owner. Where owners have no names,
// files that jobs name count toward nobody. A file that nobody needs (blob_claims.hpp) is removed when
// another needs its room, or else after about a day.
//
// Jobs in memory hold their files. Those of the other stored jobs are found by reading all jobs, before the
// first file is removed, and again after jobs were deleted: a mark-and-sweep. Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "server/blobs/blob_claims.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/blobs/partial_uploads.hpp"
#include "server/limits.hpp"

namespace tessera::blobs {

using TakeBundle = std::function<void(const std::string& owner, const v1::Bundle&)>;

struct SceneFilesOptions {
  server::Limits limits;
  std::chrono::seconds keep_unused;
  std::function<BlobClaims::Time()> now;
  // Passes on the bundles of all stored jobs, also of those that are stored meanwhile.
  std::function<core::Status(const TakeBundle&)> for_each_stored_bundle = [](const TakeBundle&) {
    return core::Status();
  };
};

class SceneFiles {
 public:
  SceneFiles(BlobStore blobs, SceneFilesOptions options);

  // ---- References ----
  // The bundle's files stay as long as the returned object exists.
  BlobClaims::Hold hold(const v1::Bundle& bundle) { return claims_.hold(files_of(bundle)); }
  // The job with these files is stored and about to leave the memory, with its hold on them.
  void note_stored(const v1::Bundle& bundle);
  // Stored jobs were deleted.
  void note_deleted();
  // See BlobClaims. RESOURCE_EXHAUSTED, a temporary condition, if the caller's share of claims is used up.
  core::Result<BlobClaims::Use> claim(const std::string& caller, std::vector<proto::Digest> files);
  core::Result<BlobClaims::Use> use(const std::string& caller, const proto::Digest& file);

  // ---- Room ----
  // For an upload that is registered as a use, or of which only the size is known: see
  // BlobWriter::name_by_content(). RESOURCE_EXHAUSTED if there is no room left for this caller.
  core::Result<BlobWriter> write(const std::string& caller, const proto::Digest& file);
  // As write(), but removes files that nobody needs, least recently used first, and then interrupted uploads,
  // until there is room. Blocks meanwhile.
  core::Result<BlobWriter> write_making_room(const std::string& caller, const proto::Digest& file);
  // ---- Interrupted uploads (partial_uploads.hpp) ----
  void keep_partial(const std::string& caller, BlobWriter writer) {
    partial_.keep(caller, std::move(writer));
  }
  std::uint64_t partial_bytes(const std::string& caller, const proto::Digest& file) {
    return partial_.size_bytes(caller, file);
  }
  // Continues an upload of this caller at `offset_bytes`. OUT_OF_RANGE unless that is how much of it is kept;
  // it then stays.
  core::Result<BlobWriter> continue_partial(const std::string& caller, const proto::Digest& file,
                                            std::uint64_t offset_bytes);

  // Charges the files to this owner, whose job names them.
  void charge_to(const std::string& owner, const v1::Bundle& bundle);
  // The bytes of all files, including uploads in progress.
  std::uint64_t used_bytes() const { return room_.held(); }
  std::uint64_t limit_bytes() const { return options_.limits.store_bytes(); }

  // Removes files that nobody has needed for long, and old interrupted uploads. Blocks.
  void collect();

 private:
  struct Unneeded {
    std::filesystem::file_time_type last_used;
    proto::Digest file;
  };
  // Files that nobody needs, least recently used first. Blocks while jobs are read. Empty if that fails.
  std::vector<Unneeded> unneeded();
  // Finds the files that stored jobs name. Whether that is known.
  bool mark_stored();
  void mark(const v1::Bundle& bundle);
  bool is_stored(const proto::Digest& file) const;
  bool remove(const proto::Digest& file);
  Charge take_room(const std::string& caller, std::uint64_t bytes);  // null if there is none
  core::Error no_room(const std::string& caller, std::uint64_t bytes) const;
  core::Error too_many_claims(const std::string& caller) const;

  const BlobStore blobs_;
  const SceneFilesOptions options_;
  const BlobClaims::Time opened_at_;
  base::FairShare room_;  // bytes
  BlobClaims claims_;
  PartialUploads partial_;

  core::Mutex marking_;  // held while jobs are read
  mutable core::Mutex marks_mutex_;
  // Files that stored jobs name, with the reading that found it last.
  std::map<proto::Digest, std::uint64_t> marks_ TESSERA_GUARDED_BY(marks_mutex_);
  std::uint64_t reading_ TESSERA_GUARDED_BY(marks_mutex_) = 1;
  bool is_outdated_ TESSERA_GUARDED_BY(marks_mutex_) = true;  // jobs were not read yet, or were deleted since
};

}  // namespace tessera::blobs
