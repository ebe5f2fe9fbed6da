// SPDX-License-Identifier: Apache-2.0
// Rows of text in aligned columns. Stateless.
#pragma once

#include <string>
#include <vector>

namespace tessera::client {

enum class Align { kLeft, kRight };

struct Column {
  std::string title;
  Align align = Align::kLeft;
};

// One line for the titles and one for each row, which must have as many cells as there are columns. Widths
// count UTF-8 code points; cells are escaped (core/base/printable.hpp), because names are untrusted.
std::string format_table(const std::vector<Column>& columns,
                         const std::vector<std::vector<std::string>>& rows);

}  // namespace tessera::client
