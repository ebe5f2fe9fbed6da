// SPDX-License-Identifier: Apache-2.0
// Parses the corners of OBJ faces. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace tessera::core {

// Appends a corner (v, v/vt, v//vn or v/vt/vn) to `text` in one of these forms; an empty or zero index of a
// texture coordinate or normal is left out. For anything else, returns false and leaves `text` unchanged.
bool append_corner(std::string_view word, std::string& text);

}  // namespace tessera::core
