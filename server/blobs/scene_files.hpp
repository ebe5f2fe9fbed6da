// SPDX-License-Identifier: Apache-2.0
// The files of scenes: their users, the room that they take, and which of them are removed when there is none
// left.
//
// A file takes room from the start of its upload. It counts toward the share of the uploader
// (fair_share.hpp), and once a job names it, toward that of the submitter. Where submitters have no names,
// files that jobs name count toward nobody. A file that nobody needs (blob_claims.hpp) is removed when
// another needs its room, or else after about a day. Thread-safe.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/blobs/blob_claims.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/limits.hpp"

namespace tessera::blobs {

struct SceneFilesOptions {
  server::Limits limits;
  std::chrono::seconds keep_unused;
  std::function<BlobClaims::Time()> now;
};

class SceneFiles {
 public:
  SceneFiles(BlobStore blobs, SceneFilesOptions options);

  // ---- References ----
  // The bundle's files stay as long as the returned object exists.
  BlobClaims::Hold hold(const v1::Bundle& bundle) { return claims_.hold(files_of(bundle)); }
  // See BlobClaims. RESOURCE_EXHAUSTED, a temporary condition, if the caller's share of claims is used up.
  core::Result<BlobClaims::Use> claim(const std::string& caller, std::vector<proto::Digest> files);
  core::Result<BlobClaims::Use> use(const std::string& caller, const proto::Digest& file);

  // ---- Room ----
  // For an upload that is registered as a use. RESOURCE_EXHAUSTED if there is no room left for this caller.
  core::Result<BlobWriter> write(const std::string& caller, const proto::Digest& file);
  // As write(), but removes files that nobody needs, least recently used first, until there is room. Blocks
  // meanwhile.
  core::Result<BlobWriter> write_making_room(const std::string& caller, const proto::Digest& file);
  // Charges the files to this submitter, whose job names them.
  void charge_to(const std::string& submitter, const v1::Bundle& bundle);
  // The bytes of all files, including uploads in progress.
  std::uint64_t used_bytes() const { return room_.held(); }

  // Removes files that nobody has needed for long. Blocks.
  void collect();

 private:
  struct Unneeded {
    std::filesystem::file_time_type last_used;
    proto::Digest file;
  };
  // Files that nobody needs, least recently used first.
  std::vector<Unneeded> unneeded();
  bool remove(const proto::Digest& file);
  Charge take_room(const std::string& caller, std::uint64_t bytes);  // null if there is none
  core::Error no_room(const std::string& caller, std::uint64_t bytes) const;
  core::Error too_many_claims(const std::string& caller) const;

  const BlobStore blobs_;
  const SceneFilesOptions options_;
  const BlobClaims::Time opened_at_;
  base::FairShare room_;  // bytes
  BlobClaims claims_;
};

}  // namespace tessera::blobs
