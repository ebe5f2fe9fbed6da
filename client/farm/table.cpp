// SPDX-License-Identifier: Apache-2.0
#include "client/farm/table.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "client/text_width.hpp"
#include "core/base/printable.hpp"

namespace tessera::client {
namespace {

constexpr std::size_t kGapColumns = 2;
// Flexible columns are not made narrower than this.
constexpr std::size_t kMinColumns = 8;

using Lines = std::vector<std::vector<std::string>>;

std::vector<std::size_t> widths_of(const std::vector<Column>& columns, const Lines& lines) {
  std::vector<std::size_t> widths(columns.size(), 0);
  for (const auto& line : lines)
    for (std::size_t i = 0; i < columns.size(); ++i) widths[i] = std::max(widths[i], text_width(line[i]));
  return widths;
}

std::size_t total(const std::vector<std::size_t>& widths) {
  std::size_t sum = widths.empty() ? 0 : kGapColumns * (widths.size() - 1);
  for (const std::size_t width : widths) sum += width;
  return sum;
}

// Shortens the widest flexible columns until the table is at most `most` wide, as far as possible.
void shrink(const std::vector<Column>& columns, std::vector<std::size_t>& widths, std::size_t most) {
  while (total(widths) > most) {
    std::optional<std::size_t> widest;
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns[i].is_flexible && widths[i] > kMinColumns && (!widest || widths[i] > widths[*widest]))
        widest = i;
    if (!widest) return;
    --widths[*widest];
  }
}

void drop_column(std::vector<Column>& columns, Lines& lines, std::size_t column) {
  const auto at = static_cast<std::ptrdiff_t>(column);
  columns.erase(columns.begin() + at);
  for (auto& line : lines) line.erase(line.begin() + at);
}

// The widths of the columns that remain.
std::vector<std::size_t> fit(std::vector<Column>& columns, Lines& lines, std::size_t most) {
  while (true) {
    std::vector<std::size_t> widths = widths_of(columns, lines);
    shrink(columns, widths, most);
    const auto least_important =
        std::max_element(columns.begin(), columns.end(), [](auto& a, auto& b) { return a.rank < b.rank; });
    if (total(widths) <= most || least_important->rank == 0) return widths;
    drop_column(columns, lines, static_cast<std::size_t>(least_important - columns.begin()));
  }
}

std::string format_cell(const Column& column, const std::string& cell, std::size_t width, bool colored) {
  std::string text = shortened(cell, width);
  const std::string space(width - std::min(width, text_width(text)), ' ');
  if (colored && column.color != nullptr) {
    const std::string_view begin = begin_color(column.color(cell));
    if (!begin.empty()) text = std::string(begin) + text + std::string(end_color());
  }
  return column.align == Align::kLeft ? text + space : space + text;
}

std::string format_line(const std::vector<Column>& columns, const std::vector<std::size_t>& widths,
                        const std::vector<std::string>& cells, bool colored) {
  std::string line;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i > 0) line += std::string(kGapColumns, ' ');
    line += format_cell(columns[i], cells[i], widths[i], colored);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

// The lines of a text that is wrapped at spaces; a longer word has a line of its own.
std::vector<std::string> wrapped(const std::string& text, std::size_t most) {
  std::vector<std::string> lines(1);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    std::string& line = lines.back();
    if (line.empty())
      line = word;
    else if (text_width(line) + 1 + text_width(word) <= most)
      line += " " + word;
    else
      lines.push_back(word);
    begin = end + 1;
  }
  return lines;
}

}  // namespace

std::string format_table(std::vector<Column> columns, std::vector<std::vector<std::string>> rows,
                         const TextStyle& style) {
  Lines lines(1);
  for (const Column& column : columns) lines[0].push_back(column.title);
  std::move(rows.begin(), rows.end(), std::back_inserter(lines));
  for (auto& line : lines) std::transform(line.begin(), line.end(), line.begin(), core::printable);
  const auto widths = style.columns ? fit(columns, lines, static_cast<std::size_t>(*style.columns))
                                    : widths_of(columns, lines);
  std::string text;
  for (const auto& line : lines)
    text += format_line(columns, widths, line, style.colored && &line != &lines.front());
  return text;
}

std::string format_description(std::vector<std::pair<std::string, std::string>> rows,
                               const TextStyle& style) {
  std::size_t indent = 0;
  for (auto& [name, value] : rows) {
    name = core::printable(name);
    value = core::printable(value);
    indent = std::max(indent, text_width(name) + kGapColumns);
  }
  std::string text;
  for (const auto& [name, value] : rows) {
    const auto most = static_cast<std::size_t>(style.columns.value_or(0));
    std::string begin = name + std::string(indent - text_width(name), ' ');
    const auto lines = style.columns ? wrapped(value, std::max(most, indent + kMinColumns) - indent)
                                     : std::vector<std::string>{value};
    for (const std::string& line : lines) {
      text += begin + line;
      text.erase(text.find_last_not_of(' ') + 1);
      text += "\n";
      begin = std::string(indent, ' ');
    }
  }
  return text;
}

}  // namespace tessera::client
