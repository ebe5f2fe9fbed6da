// SPDX-License-Identifier: Apache-2.0
// Detects damage to SQLite's write-ahead log. SQLite takes the first frame with a wrong checksum for the end
// of the log, and silently drops what follows it. Only reads the file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/error.hpp"

namespace tessera::store {

// The log that belongs to a database.
std::filesystem::path log_of(const std::filesystem::path& database);

struct LogFindings {
  // The damage as a sentence; empty if the log is intact or does not exist.
  std::optional<std::string> damage;
  // If the last transaction is incomplete and will not count: a sentence that says what may be lost. It is
  // not necessarily damage, since a crash during an unacknowledged transaction leaves the same.
  std::optional<std::string> torn_end;
};

// Fails if the log cannot be read.
core::Result<LogFindings> look_at_log(const std::filesystem::path& log);

}  // namespace tessera::store
