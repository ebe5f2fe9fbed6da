// SPDX-License-Identifier: Apache-2.0
// The file-system calls of the store, with errors that name the file and say what to do. Thread-safe: there
// is no shared state.
#pragma once

#include <sys/statvfs.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"

namespace tessera::base {

using Fd = core::OpenFile;

// The error for a failed system call on `path`, from errno: "writing /var/lib/x: the disk is full: free some
// space".
core::Error errno_error(std::string_view doing, const std::filesystem::path& path);

// Writes all of `bytes` at the descriptor's position.
core::Status write_all(const Fd& fd, std::string_view bytes, const std::filesystem::path& path);

// Makes writes durable; for a folder, the names in it.
core::Status sync_file(const Fd& fd, const std::filesystem::path& path);
core::Status sync_folder(const std::filesystem::path& folder);

// Why nothing can be written there: the file system is full or read-only. Empty if it is neither, or if that
// cannot be told.
std::string write_obstacle(const std::filesystem::path& folder);
std::string write_obstacle(const struct statvfs& file_system);

// Creates the folder and its missing parents, accessible by this user only.
core::Status create_folder(const std::filesystem::path& folder);

}  // namespace tessera::base
