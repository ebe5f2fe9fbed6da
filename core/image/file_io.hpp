// SPDX-License-Identifier: Apache-2.0
// Whole files in, whole files out: a file written here is complete or does not exist.
// Stateless; thread-safe for different paths. Errors name the file and say why.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// At most 16 GiB.
Result<std::string> read_file(const std::string& path);

// Writes beside the target, flushes to disk and renames, so that `path` holds either what it held before or
// all of `bytes`; after an error nothing is left behind. Links are followed. What is not a regular file (a
// pipe, /dev/stdout) is written to directly.
Status write_file_atomically(const std::string& path, std::string_view bytes);

// Whether a file could be written at `path` now, without touching it: for asking before long work.
Status check_can_write(const std::string& path);

}  // namespace tessera::core
