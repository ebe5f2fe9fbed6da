// Files in a folder of a cache that processes share: which of them are kept, and for how long. Thread-safe;
// other processes may add and remove files at any time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace tessera::core {

// Counts a file of the cache as used now, so that it is not removed for a while.
void mark_as_used(const std::string& path);

// Removes the files that were not used for longest until those that are left have no more than `max_bytes`;
// but none that was used within the last hour, which may be read at this moment, and none whose name
// `is_ours` does not know: the folder may be somebody's.
void remove_least_used(const std::string& folder, std::uint64_t max_bytes,
                       const std::function<bool(const std::string& name)>& is_ours);

// Removes what writers that died have left: files that nobody has written to for a day.
void remove_abandoned(const std::string& folder,
                      const std::function<bool(const std::string& name)>& is_partial);

}  // namespace tessera::core
