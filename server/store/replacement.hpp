// SPDX-License-Identifier: Apache-2.0
// Replaces a database by another and keeps the old one under a name of its own. At every moment the old one
// exists with its log, under one of the names. The caller holds the state's lock, and nobody may have either
// database open.
#pragma once

#include <filesystem>

#include "core/base/error.hpp"

namespace tessera::store {

// Renames `copy`, which must have no log, to `database`. Returns the new names of the old database and its
// log. Blocks until that is synced to disk. After an error the old database is in its place.
core::Result<std::filesystem::path> replace_database(const std::filesystem::path& database,
                                                     const std::filesystem::path& copy);

// Restores the database's log if a crash interrupted a replacement. Otherwise does nothing.
core::Status undo_interrupted_replacement(const std::filesystem::path& database);

}  // namespace tessera::store
