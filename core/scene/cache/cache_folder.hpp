// SPDX-License-Identifier: Apache-2.0
// Files in a folder of a cache that processes share: which of them are kept, and for how long. Thread-safe;
// other processes may add and remove files at any time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/error.hpp"

namespace tessera::core {

using IsName = std::function<bool(const std::string& name)>;

// Creates the folder where it is missing, for this user alone to write to. Errors name it and say why it
// cannot be used.
Status make_folder(const std::string& path);

// Refuses a folder that belongs to another user, or that others may write to: what lies there could be
// theirs.
Status check_is_own(const std::string& folder);

// Where to write what shall be at `path` once it is complete: no other writer, on whatever machine, has the
// same.
std::string partial_path_of(const std::string& path);

// Counts a file of the cache as used now, so that it is not removed for a while.
void mark_as_used(const std::string& path);

// Removes the files that were not used for longest until those that are left have no more than `max_bytes`.
// What was used within the last hour stays, as somebody may be about to open it, unless its name is one of
// those that `can_go_at_once`; so does what is being written, which counts nonetheless, and what has a name
// that `is_ours` does not know: the folder may be somebody's.
void remove_least_used(const std::string& folder, std::uint64_t max_bytes, const IsName& is_ours,
                       const IsName& can_go_at_once);

// Removes what writers that died have left: partial files of ours that nobody has written to for a day.
void remove_abandoned(const std::string& folder, const IsName& is_ours);

}  // namespace tessera::core
