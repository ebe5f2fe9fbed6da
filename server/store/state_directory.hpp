// SPDX-License-Identifier: Apache-2.0
// The state directory of a coordinator:
//
//   lock          locked while a coordinator runs on it, as the folder itself is
//   tessera.db    jobs and films (job_store.hpp)
//   blobs/        scenes and their assets (blob_store.hpp)
//   sessions      who is logged in to the page (http/sessions.hpp)
//
// A tessera.db-wal beside the database belongs to it: after a crash it has the last few seconds. A backup
// (admin/backup.hpp) has a database, blobs, and a list of both, and no coordinator starts on it.
#pragma once

#include <filesystem>

#include "core/base/error.hpp"
#include "server/base/file.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/store/job_store.hpp"

namespace tessera::store {

inline constexpr const char* kDatabaseName = "tessera.db";
inline constexpr const char* kBlobsName = "blobs";
inline constexpr const char* kSessionsName = "sessions";
// The list of the files of a backup.
inline constexpr const char* kBackupListName = "tessera-backup.sha256";

// The lock of a state, until it is destroyed. That of the folder holds even if somebody removes the file,
// which is what earlier releases lock.
struct FolderLock {
  base::Fd folder, file;
};

// Locks a state for reading: no coordinator can start while the lock is held. Creates nothing; without a file
// for a copy that has none. NOT_FOUND if no coordinator has ever run on the folder, FAILED_PRECONDITION if
// one runs now.
core::Result<FolderLock> lock_existing_state(const std::filesystem::path& folder);
// The same for salvaging: creates the lock file if there is none. FAILED_PRECONDITION for a backup.
core::Result<FolderLock> lock_state_to_mend(const std::filesystem::path& folder);
// The same for a state that is to be written: creates the folder. FAILED_PRECONDITION if it has a database.
core::Result<FolderLock> lock_new_state(const std::filesystem::path& folder);

// Writes the database of a state as it is at one moment to a new file, also while a coordinator runs on the
// state, which is not delayed. Blocks for the disk. Errors are those of lock_existing_state(), but for a
// coordinator that runs; DATA_LOSS if the log is damaged.
core::Status copy_database(const std::filesystem::path& folder, const std::filesystem::path& copy);

struct StateDirectory {
  // Creates what is missing. FAILED_PRECONDITION if another coordinator runs on it, or if it is a backup;
  // otherwise the errors of file.hpp and job_store.hpp.
  static core::Result<StateDirectory> open(const std::filesystem::path& folder);

  std::filesystem::path folder;
  FolderLock lock;
  blobs::BlobStore blobs;
  JobStore jobs;
};

// $XDG_STATE_HOME/tessera/coordinator, by default below ~/.local/state; ./tessera-state without a home
// directory.
std::filesystem::path default_state_directory();

}  // namespace tessera::store
