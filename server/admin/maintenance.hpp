// SPDX-License-Identifier: Apache-2.0
// The maintenance commands of tessera-coordinator on a state directory. They block until they are done.
#pragma once

#include <filesystem>

namespace tessera::admin {

// Prints which parts of the directory are intact. Returns the exit status: 0 if all are, 1 if not or if that
// cannot be checked.
int check(const std::filesystem::path& state);

// Writes everything intact to a new database and prints what it kept. Returns the exit status: 0 on success.
int salvage(const std::filesystem::path& state);

// Makes a backup of the state, and prints what it has. Returns the exit status: 0 if all of it is intact.
int back_up(const std::filesystem::path& state, const std::filesystem::path& backup);

// Makes a new state of a backup. Returns the exit status: 0 on success.
int restore(const std::filesystem::path& backup, const std::filesystem::path& state);

}  // namespace tessera::admin
