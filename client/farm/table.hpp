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
// count code points of UTF-8; cells are made printable (core/base/printable.hpp), since names come from
// anyone.
std::string format_table(const std::vector<Column>& columns,
                         const std::vector<std::vector<std::string>>& rows);

}  // namespace tessera::client
