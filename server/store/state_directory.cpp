// SPDX-License-Identifier: Apache-2.0
#include "server/store/state_directory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/store/replacement.hpp"

namespace tessera::store {

namespace {

constexpr const char* kLockName = "lock";

// The lock is held until the descriptor is closed, also by a crash.
core::Status take_lock(const base::Fd& lock, const std::filesystem::path& folder,
                       std::string_view what_to_do) {
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) == 0) return {};
  if (errno != EWOULDBLOCK) return core::fail(base::errno_error("locking", folder));
  return core::fail(core::ErrorCode::kFailedPrecondition,
                    fmt::format("another coordinator runs on {}: {}", folder.string(), what_to_do));
}

// The lock on the folder itself, which nobody can remove from under its database.
core::Result<base::Fd> lock_folder(const std::filesystem::path& folder, std::string_view what_to_do) {
  base::Fd lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!lock) return core::fail(base::errno_error("opening", folder));
  if (auto taken = take_lock(lock, folder, what_to_do); !taken) return core::fail(taken.error());
  return lock;
}

// To run on a backup would change it.
core::Status expect_no_backup(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder / kBackupListName, error)) return {};
  return core::fail(core::ErrorCode::kFailedPrecondition,
                    fmt::format("{} is a backup: make a state folder of it with 'tessera-coordinator "
                                "--restore {} --state NEW'",
                                folder.string(), folder.string()));
}

// `flags` of open(): whether the file may be missing, and is then created.
core::Result<FolderLock> lock_state(const std::filesystem::path& folder, int flags,
                                    std::string_view what_to_do) {
  auto locked = lock_folder(folder, what_to_do);
  if (!locked) return core::fail(locked.error());
  const std::filesystem::path path = folder / kLockName;
  base::Fd file(::open(path.c_str(), flags | O_CLOEXEC, 0600));
  if (!file && errno == ENOENT) return FolderLock{*std::move(locked), {}};
  if (!file) return core::fail(base::errno_error("opening", path));
  if (auto taken = take_lock(file, folder, what_to_do); !taken) return core::fail(taken.error());
  return FolderLock{*std::move(locked), std::move(file)};
}

core::Result<FolderLock> lock_to_write(const std::filesystem::path& folder, std::string_view what_to_do) {
  if (auto usable = expect_no_backup(folder); !usable) return core::fail(usable.error());
  return lock_state(folder, O_RDWR | O_CREAT, what_to_do);
}

core::Status expect_state(const std::filesystem::path& folder) {
  for (const char* const name : {kLockName, kDatabaseName}) {
    std::error_code error;
    if (std::filesystem::exists(folder / name, error) || error) return {};
  }
  return core::fail(core::ErrorCode::kNotFound,
                    fmt::format("there is no state of a coordinator in {}: name the folder that was given to "
                                "--state",
                                folder.string()));
}

}  // namespace

core::Result<FolderLock> lock_existing_state(const std::filesystem::path& folder) {
  if (auto there = expect_state(folder); !there) return core::fail(there.error());
  return lock_state(folder, O_RDONLY, "end it first, or make a backup of the folder with --backup");
}

core::Result<FolderLock> lock_state_to_mend(const std::filesystem::path& folder) {
  if (auto there = expect_state(folder); !there) return core::fail(there.error());
  return lock_to_write(folder, "end it first");
}

core::Result<FolderLock> lock_new_state(const std::filesystem::path& folder) {
  if (auto created = base::create_folder(folder); !created) return core::fail(created.error());
  auto lock = lock_to_write(folder, "choose another folder with --state");
  std::error_code error;
  if (lock && std::filesystem::exists(folder / kDatabaseName, error))
    return core::fail(
        core::ErrorCode::kFailedPrecondition,
        fmt::format("{} has the state of a coordinator already: choose a new folder with --state",
                    folder.string()));
  return lock;
}

core::Status copy_database(const std::filesystem::path& folder, const std::filesystem::path& copy) {
  const auto lock = lock_existing_state(folder);
  const bool has_coordinator = !lock && lock.error().code == core::ErrorCode::kFailedPrecondition;
  if (!lock && !has_coordinator) return core::fail(lock.error());
  return JobStore::copy(folder / kDatabaseName, copy, has_coordinator);
}

core::Result<StateDirectory> StateDirectory::open(const std::filesystem::path& folder) {
  if (auto created = base::create_folder(folder); !created) return core::fail(created.error());
  auto lock = lock_to_write(folder, "end it, or choose another folder with --state");
  if (!lock) return core::fail(lock.error());
  auto blobs = blobs::BlobStore::open(folder / kBlobsName);
  if (!blobs) return core::fail(blobs.error());
  if (auto settled = undo_interrupted_replacement(folder / kDatabaseName); !settled)
    return core::fail(settled.error());
  // Files are uploaded before their job, so with blobs there must be a database.
  const bool may_be_new = blobs->list().empty();
  auto jobs = JobStore::open(folder / kDatabaseName, may_be_new);
  if (!jobs) return core::fail(jobs.error());
  return StateDirectory{folder, std::move(*lock), std::move(*blobs), std::move(*jobs)};
}

std::filesystem::path default_state_directory() {
  const auto variable = [](const char* name) {
    return std::filesystem::path(std::getenv(name) ? std::getenv(name) : "");
  };
  if (const auto state = variable("XDG_STATE_HOME"); state.is_absolute())
    return state / "tessera" / "coordinator";
  if (const auto home = variable("HOME"); home.is_absolute()) {
    return home / ".local" / "state" / "tessera" / "coordinator";
  }
  return "tessera-state";
}

}  // namespace tessera::store
