// SPDX-License-Identifier: Apache-2.0
// Reads and writes whole files: a file written here is complete or does not exist. Stateless; thread-safe
// for different paths. Error messages name the file and the reason.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// Reads at most 16 GiB.
Result<std::string> read_file(const std::string& path);

// Writes a temporary file beside the target, flushes it to disk and renames it. `path` holds either its
// previous content or all of `bytes`; an error leaves nothing behind. A temporary file that a killed process
// has left (.NAME.N.tmp) is removed when the same file is written again. Links are followed. A target
// that is not a regular file (a pipe, /dev/stdout) is written directly.
Status write_file_atomically(const std::string& path, std::string_view bytes);

// Checks whether a file could be written at `path`, without touching it. Call it before long work.
Status check_can_write(const std::string& path);

}  // namespace tessera::core
