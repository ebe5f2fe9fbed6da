// SPDX-License-Identifier: Apache-2.0
// The folder in which a coordinator keeps what must survive it:
//
//   lock          held while a coordinator runs on it
//   tessera.db    jobs and films (job_store.hpp)
//   blobs/        scenes and their assets (blob_store.hpp)
//
// A tessera.db-wal beside the database belongs to it: after a crash it has the last few seconds.
// Copying the folder while no coordinator runs on it is a backup.
#pragma once

#include <filesystem>

#include "core/base/error.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/file.hpp"
#include "server/store/job_store.hpp"

namespace tessera::store {

inline constexpr const char* kDatabaseName = "tessera.db";
inline constexpr const char* kBlobsName = "blobs";

// For looking at a state: held, it keeps every coordinator off. Creates nothing; empty for a copy without a
// lock. NOT_FOUND if no coordinator has ever run on the folder, FAILED_PRECONDITION if one
// does now.
core::Result<Fd> lock_existing_state(const std::filesystem::path& folder);
// The same for mending it: creates the lock where there is none.
core::Result<Fd> lock_state_to_mend(const std::filesystem::path& folder);

struct StateDirectory {
  // Creates what is missing. FAILED_PRECONDITION if another coordinator runs on it; otherwise what file.hpp
  // and job_store.hpp say of disks and damage.
  static core::Result<StateDirectory> open(const std::filesystem::path& folder);

  Fd lock;
  BlobStore blobs;
  JobStore jobs;
};

// $XDG_STATE_HOME/tessera/coordinator, by default below ~/.local/state; ./tessera-state where there is no
// home.
std::filesystem::path default_state_directory();

}  // namespace tessera::store
