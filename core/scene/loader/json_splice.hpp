// SPDX-License-Identifier: Apache-2.0
// Replaces values in the text of a JSON file, which keeps its comments and the numbers of its lines.
// Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// Whether this is the path of a value: "camera.position", "lights[0].intensity".
bool is_value_path(std::string_view path);

// `text` as a JSON string in quotes.
std::string json_string(const std::string& text);

// `text`, which must be valid JSON with comments, with the JSON `value` at the path. An object that lacks the
// key gets it. INVALID_ARGUMENT names the path, and what is not there.
Result<std::string> with_json_value(std::string text, const std::string& path, const std::string& value);

}  // namespace tessera::core
