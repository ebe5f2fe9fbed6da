#include "server/store/state_directory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>
#include <cstdlib>
#include <utility>

namespace tessera::store {

namespace {

// Held until the descriptor is closed, even by a crash.
core::Result<Fd> take_lock(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "lock";
  Fd lock(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!lock) return core::fail(errno_error("opening", path));
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) == 0) return lock;
  if (errno != EWOULDBLOCK) return core::fail(errno_error("locking", path));
  return core::fail(
      core::ErrorCode::kFailedPrecondition,
      fmt::format("another coordinator runs on {}: end it, or choose another folder with --state",
                  folder.string()));
}

}  // namespace

core::Result<StateDirectory> StateDirectory::open(const std::filesystem::path& folder) {
  if (auto created = create_folder(folder); !created) return core::fail(created.error());
  auto lock = take_lock(folder);
  if (!lock) return core::fail(lock.error());
  auto blobs = BlobStore::open(folder / "blobs");
  if (!blobs) return core::fail(blobs.error());
  auto jobs = JobStore::open(folder / "tessera.db");
  if (!jobs) return core::fail(jobs.error());
  return StateDirectory{std::move(*lock), std::move(*blobs), std::move(*jobs)};
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
