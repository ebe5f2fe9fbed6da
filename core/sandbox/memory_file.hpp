// SPDX-License-Identifier: Apache-2.0
// Files in memory as standard input and output of a process, so that neither side blocks on the other.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"

namespace tessera::sandbox {

// A new file with this content, to be read from its start. `name` is for people who look into /proc.
core::Result<core::OpenFile> create_memory_file(const char* name, std::string_view content = {});

// The content from the start on. RESOURCE_EXHAUSTED if it has more than `max_bytes`.
core::Result<std::string> read_memory_file(const core::OpenFile& file, std::size_t max_bytes);

}  // namespace tessera::sandbox
