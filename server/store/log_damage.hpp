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
  // Its last transaction is there in parts, and will not count. That is no damage: a crash that tears the one
  // it interrupts, of which nobody has heard, leaves the same.
  bool torn_end = false;
};

// Errors: it cannot be read.
core::Result<LogFindings> look_at_log(const std::filesystem::path& log);

}  // namespace tessera::store
