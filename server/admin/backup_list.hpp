// SPDX-License-Identifier: Apache-2.0
// The list of the files of a backup, tessera-backup.sha256: a comment with their number, and a line for each
// with its SHA-256 and its path, as `sha256sum --check` reads it. It tells a whole backup from one of which
// files are missing or damaged. Thread-safe: there is no shared state.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "proto/blob.hpp"

namespace tessera::admin {

// The SHA-256 of each file in hexadecimal digits, by its path in the backup.
using BackupFiles = std::map<std::string, std::string>;

// Whether the folder has such a list.
bool is_backup(const std::filesystem::path& folder);

// Writes the list of a backup, which has none yet, and syncs it to disk.
core::Status write_backup_list(const std::filesystem::path& backup, const BackupFiles& files);

// Reads the list, and every file that it names. NOT_FOUND if the folder is no backup; DATA_LOSS if the list
// is damaged or cut off, or if a file is missing or damaged: the message names it.
core::Result<BackupFiles> read_whole_backup(const std::filesystem::path& backup);

// The path in the backup of the blob with this SHA-256 in hexadecimal digits.
std::string blob_path(std::string_view digits);

// The digest of a file's content.
core::Result<proto::Digest> digest_of_file(const std::filesystem::path& file);

}  // namespace tessera::admin
