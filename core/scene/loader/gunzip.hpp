// SPDX-License-Identifier: Apache-2.0
// Decompresses gzip files (RFC 1952). Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// Whether the bytes begin as a gzip file does.
bool is_gzip(std::string_view bytes);

// The bytes of a file as they are or, if they begin as a gzip file does, what that holds in its one member,
// which is stored in `content`. Files that claim to hold more than 256 times their own size are refused,
// since they are made to exhaust memory. Errors complete a sentence that begins with the file's name.
Result<std::string_view> gunzipped(std::string_view bytes, std::string& content);

}  // namespace tessera::core
