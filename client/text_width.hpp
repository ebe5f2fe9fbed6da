// SPDX-License-Identifier: Apache-2.0
// The columns that text takes on a terminal: two for wide characters, none for combining ones. The text must
// be printable (core/base/printable.hpp). Thread-safe; independent of the process's locale.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tessera::client {

std::size_t text_width(std::string_view text);

// The text, or its beginning and "…", in at most `columns` columns.
std::string shortened(std::string_view text, std::size_t columns);

}  // namespace tessera::client
