// SPDX-License-Identifier: Apache-2.0
// Backups of a coordinator's state: a folder with the database as it is at one moment, the files that its
// jobs name, and a list of both (backup_list.hpp). Both functions block for the disk. Thread-safe: there is
// no shared state.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::admin {

struct Backup {
  std::size_t jobs = 0, files = 0;
  // What was damaged in the state already: one sentence each.
  std::vector<std::string> damage;
};

// Makes a backup of a state, also while a coordinator runs on it, and reads all of it again. Files of scenes
// are hard links where the file system of the state has the backup as well. The folder appears when it is
// whole. FAILED_PRECONDITION if it exists already; DATA_LOSS if the structure of the database is damaged.
core::Result<Backup> back_up_state(const std::filesystem::path& state, const std::filesystem::path& backup);

// Makes a new state of a backup, and returns the number of files. Reads the whole backup first: the errors of
// read_whole_backup(). FAILED_PRECONDITION if the state has a database, or a coordinator runs on it. The
// database appears last, so that no coordinator starts on half a state; after an error it can be tried again.
core::Result<std::size_t> restore_state(const std::filesystem::path& backup,
                                        const std::filesystem::path& state);

}  // namespace tessera::admin
