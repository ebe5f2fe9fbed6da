// SPDX-License-Identifier: Apache-2.0
// What SQLite does not tell of its write-ahead log: it takes the first frame that does not check for the end
// of the log, and so forgets without a word what a damaged disk has cut off. Reads the file alone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/error.hpp"

namespace tessera::store {

// The log that belongs to a database.
std::filesystem::path log_of(const std::filesystem::path& database);

struct LogFindings {
  // Where the log is damaged, as a sentence; nothing if it is whole, or not there.
  std::optional<std::string> damage;
  // That its last transaction is there in parts, and will not count, as a sentence that says what may be
  // lost. That is no damage for sure: a crash that tears the one it interrupts, of which nobody has heard,
  // leaves the same.
  std::optional<std::string> torn_end;
};

// Errors: it cannot be read.
core::Result<LogFindings> look_at_log(const std::filesystem::path& log);

}  // namespace tessera::store
