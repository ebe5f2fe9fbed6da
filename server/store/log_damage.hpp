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

// Where the log is damaged, as a sentence; nothing if it is whole, or not there. Of damage to the last
// transaction alone nothing is told: a crash that tears the one it interrupts, of which nobody has heard,
// leaves the same. Errors: it cannot be read.
core::Result<std::optional<std::string>> find_log_damage(const std::filesystem::path& log);

}  // namespace tessera::store
