// SPDX-License-Identifier: Apache-2.0
// Decompresses gzip files (RFC 1952). Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// Whether the bytes begin as a gzip file does.
bool is_gzip(std::string_view bytes);

// The content of a file with one member. Files that claim to hold more than 256 times their own size are
// refused, since they are made to exhaust memory. Errors complete a sentence that begins with the file's
// name.
Result<std::string> gunzip(std::string_view bytes);

}  // namespace tessera::core
