// SPDX-License-Identifier: Apache-2.0
#include "proto/text.hpp"

#include <fmt/format.h>

#include <string>

#include "core/base/printable.hpp"
#include "proto/error_reasons.hpp"

namespace tessera::proto {

core::Error invalid_field(std::string_view field, std::string_view problem) {
  const core::Error error{core::ErrorCode::kInvalidArgument, fmt::format("{}: {}", field, problem)};
  return error.with({.reason = kInvalidField, .field = std::string(field)});
}

core::Status check_text(std::string_view what, std::string_view text, std::size_t most_bytes) {
  if (text.size() > most_bytes)
    return core::fail(
        invalid_field(what, fmt::format("must have at most {} bytes, got {}", most_bytes, text.size())));
  if (core::is_printable(text)) return {};
  return core::fail(invalid_field(
      what, fmt::format("must be UTF-8 without line breaks and other control characters, got '{}'",
                        core::printable(text))));
}

}  // namespace tessera::proto
