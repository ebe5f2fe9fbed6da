// SPDX-License-Identifier: Apache-2.0
#include "proto/text.hpp"

#include <fmt/format.h>

#include "core/base/printable.hpp"

namespace tessera::proto {

core::Status check_text(std::string_view what, std::string_view text, std::size_t most_bytes) {
  if (text.size() > most_bytes) {
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("{}: must have at most {} bytes, got {}", what, most_bytes, text.size()));
  }
  if (core::is_printable(text)) return {};
  return core::fail(
      core::ErrorCode::kInvalidArgument,
      fmt::format("{}: must be UTF-8 without line breaks and other control characters, got '{}'", what,
                  core::printable(text)));
}

}  // namespace tessera::proto
