// SPDX-License-Identifier: Apache-2.0
// Explains in plain words why a text is not JSON, based on nlohmann's error. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// An error of nlohmann's SAX interface.
struct JsonParserError {
  std::size_t position;         // how many characters were read, the end of the text counting as one or more
  std::string_view last_token;  // reliable for strings and numbers only; else preceded by earlier characters
  std::string_view
      message;  // "[json.exception.parse_error.101] parse error at line 1, column 7: syntax error ..."
};

// "FILE:3:7: not valid JSON: found '}' where a value is due".
Error explain_json_error(std::string_view text, const std::string& file, const JsonParserError& error);

// Reports a NUL character at `position`.
Error explain_nul(std::string_view text, const std::string& file, std::size_t position);

}  // namespace tessera::core
