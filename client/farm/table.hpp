// SPDX-License-Identifier: Apache-2.0
// Rows of text in aligned columns that fit the terminal. Stateless.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "client/terminal.hpp"

namespace tessera::client {

enum class Align { kLeft, kRight };

struct Column {
  std::string title;
  Align align = Align::kLeft;
  // Whether cells may be cut off with an ellipsis, for names. Numbers and ids are never cut.
  bool is_flexible = false;
  // Columns of the highest rank are left out first where a terminal is too narrow; those of rank 0 stay.
  int rank = 0;
  // The colour of a cell, by its text.
  Color (*color)(const std::string& cell) = nullptr;
};

// One line for the titles and one for each row, which must have as many cells as there are columns. Cells are
// escaped (core/base/printable.hpp), because names are untrusted. If the lines are wider than the terminal,
// the widest flexible columns are shortened first, then columns are left out by rank.
std::string format_table(std::vector<Column> columns, std::vector<std::vector<std::string>> rows,
                         const TextStyle& style = {});

// One line for each row, a name and a value, with the values below each other; escaped. On a terminal, values
// are wrapped at spaces.
std::string format_description(std::vector<std::pair<std::string, std::string>> rows,
                               const TextStyle& style = {});

}  // namespace tessera::client
