// SPDX-License-Identifier: Apache-2.0
// The container of NanoVDB's files (Museth 2021, "NanoVDB: A GPU-friendly and portable VDB data structure",
// version 32): segments of a header, a description of each grid, and the grids, which may be compressed.
// Little-endian.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// The bytes of the first grid of this name: a part of `file`, or decompressed into `content`. nullopt if the
// file has none. Errors complete a sentence that begins with the file's name: INVALID_ARGUMENT for a damaged
// file or a compression that is not read, RESOURCE_EXHAUSTED for one that expands as no grid does.
Result<std::optional<std::string_view>> find_nanovdb_grid(std::string_view file, std::string_view name,
                                                          std::string& content);

}  // namespace tessera::core
