// SPDX-License-Identifier: Apache-2.0
// The target of a request line, such as "/jobs/a%20b?size=256". Pure functions.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace tessera::http {

struct RequestTarget {
  std::string path;                          // decoded
  std::map<std::string, std::string> query;  // decoded; of parameters with the same name the first one
};

// Empty if it is no absolute path, or an escape is malformed or encodes a control character.
std::optional<RequestTarget> parse_target(std::string_view target);

}  // namespace tessera::http
