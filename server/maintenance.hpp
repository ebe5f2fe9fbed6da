// SPDX-License-Identifier: Apache-2.0
// What tessera-coordinator does to a state folder instead of running on it. Blocks until it is done.
#pragma once

#include <filesystem>

namespace tessera::server {

// Prints what of the folder is whole. The exit status: 0 if everything is, 1 if not, or if that cannot be
// told.
int check(const std::filesystem::path& state);

// Keeps what is whole in a new database and prints what that is. The exit status: 0 if that was done.
int salvage(const std::filesystem::path& state);

}  // namespace tessera::server
