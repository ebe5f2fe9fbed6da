// SPDX-License-Identifier: Apache-2.0
#include "server/store/replacement.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "server/base/file.hpp"
#include "server/store/log_damage.hpp"

namespace tessera::store {

namespace {

namespace fs = std::filesystem;

// A file that cannot be examined counts as present.
bool is_there(const fs::path& file) {
  struct ::stat status {};
  return ::lstat(file.c_str(), &status) == 0 || errno != ENOENT;
}

fs::path numbered(const fs::path& database, int number) {
  return fmt::format("{}.damaged-{}", database.string(), number);
}

fs::path free_name(const fs::path& database) {
  for (int number = 1;; ++number) {
    const fs::path name = numbered(database, number);
    if (!is_there(name) && !is_there(log_of(name))) return name;
  }
}

core::Status link(const fs::path& from, const fs::path& to) {
  if (::link(from.c_str(), to.c_str()) == 0) return {};
  return core::fail(base::errno_error("linking to " + from.string() + " from", to));
}

core::Status unlink(const fs::path& file) {
  if (::unlink(file.c_str()) == 0 || errno == ENOENT) return {};
  return core::fail(base::errno_error("removing", file));
}

core::Status link_both(const fs::path& database, const fs::path& name) {
  if (auto linked = link(database, name); !linked) return linked;
  if (!is_there(log_of(database))) return {};
  return link(log_of(database), log_of(name));
}

// The log is renamed first: SQLite would take it for the log of the new database.
core::Status put_in_place(const fs::path& copy, const fs::path& database) {
  // SQLite creates the log's index again.
  if (auto gone = unlink(database.string() + "-shm"); !gone) return gone;
  if (auto gone = unlink(log_of(database)); !gone) return gone;
  if (::rename(copy.c_str(), database.c_str()) == 0) return {};
  return core::fail(base::errno_error("renaming " + copy.string() + " to", database));
}

// The log gets its name back before the database does.
core::Status put_back(const fs::path& database, const fs::path& name) {
  if (is_there(log_of(name)) && !is_there(log_of(database))) {
    if (auto linked = link(log_of(name), log_of(database)); !linked) return linked;
  }
  if (auto safe = base::sync_folder(database.parent_path()); !safe) return safe;
  if (auto gone = unlink(log_of(name)); !gone) return gone;
  return unlink(name);
}

}  // namespace

core::Result<fs::path> replace_database(const fs::path& database, const fs::path& copy) {
  const fs::path name = free_name(database), folder = database.parent_path();
  core::Status done = link_both(database, name);
  if (done) done = base::sync_folder(folder);
  if (done) done = put_in_place(copy, database);
  if (!done) {
    [[maybe_unused]] const auto next_start_tries_again = put_back(database, name);
    return core::fail(done.error());
  }
  if (auto safe = base::sync_folder(folder); !safe) return core::fail(safe.error());
  return name;
}

core::Status undo_interrupted_replacement(const fs::path& database) {
  for (int number = 1; is_there(numbered(database, number)); ++number) {
    const fs::path name = numbered(database, number);
    std::error_code other;
    if (!fs::equivalent(database, name, other) || other) continue;
    if (auto undone = put_back(database, name); !undone) return undone;
  }
  return {};
}

}  // namespace tessera::store
