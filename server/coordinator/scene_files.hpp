// SPDX-License-Identifier: Apache-2.0
// The files of scenes: who needs them, whose room they take, and which of them go where there is none left.
//
// A file takes room from the moment that its upload begins, of the share of who uploads it (fair_share.hpp),
// and once a job names it of its submitter's; where submitters have no names, what jobs name counts for
// nobody. A file that nobody needs (blob_claims.hpp) goes when another wants its room, and without that after
// a day or so. Thread-safe.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/coordinator/blob_claims.hpp"
#include "server/limits.hpp"
#include "server/store/blob_store.hpp"

namespace tessera::coordinator {

struct SceneFilesOptions {
  server::Limits limits;
  std::chrono::seconds keep_unused;
  std::function<BlobClaims::Time()> now;
};

class SceneFiles {
 public:
  SceneFiles(store::BlobStore blobs, SceneFilesOptions options);

  // ---- Who needs them ----
  // As long as the answer exists, the bundle's files stay.
  BlobClaims::Hold hold(const v1::Bundle& bundle) { return claims_.hold(files_of(bundle)); }
  // See BlobClaims. RESOURCE_EXHAUSTED, which passes by itself, if the caller has claimed its share.
  core::Result<BlobClaims::Use> claim(const std::string& caller, std::vector<proto::Digest> files);
  core::Result<BlobClaims::Use> use(const std::string& caller, const proto::Digest& file);

  // ---- Room ----
  // For an upload that is in use. RESOURCE_EXHAUSTED if there is no room left for this caller.
  core::Result<store::BlobWriter> write(const std::string& caller, const proto::Digest& file);
  // The same after as many files as that takes were removed, of those that nobody needs the one first that
  // was used least lately. Blocks while they are looked at and removed.
  core::Result<store::BlobWriter> write_making_room(const std::string& caller, const proto::Digest& file);
  // A job of this submitter names them.
  void charge_to(const std::string& submitter, const v1::Bundle& bundle);
  // Of all files, those on their way included.
  std::uint64_t used_bytes() const { return room_.held(); }

  // Removes what nobody has needed for long. Blocks.
  void collect();

 private:
  struct Unneeded {
    std::filesystem::file_time_type last_used;
    proto::Digest file;
  };
  // Those used least lately first.
  std::vector<Unneeded> unneeded();
  bool remove(const proto::Digest& file);
  store::Charge take_room(const std::string& caller, std::uint64_t bytes);  // null if there is none
  core::Error no_room(const std::string& caller, std::uint64_t bytes) const;
  core::Error too_many_claims(const std::string& caller) const;

  const store::BlobStore blobs_;
  const SceneFilesOptions options_;
  const BlobClaims::Time opened_at_;
  FairShare room_;  // bytes
  BlobClaims claims_;
};

}  // namespace tessera::coordinator
