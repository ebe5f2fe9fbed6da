// SPDX-License-Identifier: Apache-2.0
// Manages a cache folder that processes share: which files are kept, and for how long. Thread-safe; other
// processes may add and remove files at any time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/error.hpp"

namespace tessera::core {

using IsName = std::function<bool(const std::string& name)>;

// Creates the folder if it is missing, writable by this user only. Errors name it and the reason.
Status make_folder(const std::string& path);

// Rejects a folder that belongs to another user or that others may write to, because its contents cannot be
// trusted.
Status check_is_own(const std::string& folder);

// A unique path to write to before the file is renamed to `path`: no other writer on any machine has the
// same.
std::string partial_path_of(const std::string& path);

// Marks a cache file as used now, so that others are removed before it.
void mark_as_used(const std::string& path);

// Whether a file is kept although room is needed, by its name and the time since its last use.
using MustStay = std::function<bool(const std::string& name, std::chrono::seconds unused_for)>;

// Files used within this time may be about to be opened.
inline constexpr std::chrono::hours kMayBeInUse{1};

// Removes the least recently used files until the rest take at most `max_bytes`, and returns what the rest
// takes: more if too much must stay. Partial files count; they stay while they are written to, that is, for
// an hour after the last time. Files whose names `is_ours` rejects stay and do not count: they may belong to
// the user.
std::uint64_t remove_least_used(const std::string& folder, std::uint64_t max_bytes, const IsName& is_ours,
                                const MustStay& must_stay);

// Removes partial files of the cache that have not been written to for a day, left by writers that died.
void remove_abandoned(const std::string& folder, const IsName& is_ours);

}  // namespace tessera::core
