// SPDX-License-Identifier: Apache-2.0
// A database in the place of another, which is kept under a name of its own. Whatever happens on the way, the
// old one is there with its log, under one name or the other.
// For whoever holds the state's lock, while nobody has either database open.
#pragma once

#include <filesystem>

#include "core/base/error.hpp"

namespace tessera::store {

// Renames `copy`, which must stand without a log, to `database`; answers with what the old database and its
// log are called now. Blocks until that is safe on disk. After an error the old one is where it was.
core::Result<std::filesystem::path> replace_database(const std::filesystem::path& database,
                                                     const std::filesystem::path& copy);

// Gives the database back the log that a replacement took, if that was cut short by a crash. Nothing happens
// otherwise.
core::Status undo_interrupted_replacement(const std::filesystem::path& database);

}  // namespace tessera::store
