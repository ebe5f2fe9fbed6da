// SPDX-License-Identifier: Apache-2.0
// The corners of faces as OBJ files write them. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace tessera::core {

// Appends a corner (v, v/vt, v//vn or v/vt/vn) to `text` in one of these four forms; an index of texture
// coordinate or normal that is empty or 0 is left out. False, with `text` as it was, for anything else.
bool append_corner(std::string_view word, std::string& text);

}  // namespace tessera::core
