// SPDX-License-Identifier: Apache-2.0
#include "server/admin/database_copy.hpp"

#include <fmt/format.h>

#include <system_error>

#include "server/store/log_damage.hpp"

namespace tessera::admin {

void remove_database(const std::filesystem::path& file) {
  for (const char* ending : {"", "-wal", "-shm"}) {
    std::error_code ignored;  // opening the new database reports what could not be removed
    std::filesystem::remove(file.string() + ending, ignored);
  }
}

core::Status expect_empty_log(const std::filesystem::path& database) {
  const std::filesystem::path log = store::log_of(database);
  std::error_code missing;
  if (std::filesystem::file_size(log, missing) == 0 || missing == std::errc::no_such_file_or_directory)
    return {};
  return core::fail(
      core::ErrorCode::kInternal,
      fmt::format("{} is not empty after its database was closed: nothing was replaced; try again",
                  log.string()));
}

}  // namespace tessera::admin
