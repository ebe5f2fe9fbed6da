// SPDX-License-Identifier: Apache-2.0
// Lines and words of OBJ and MTL files: a line ends with \n, \r\n or \r, words are separated by
// blanks, a comment goes from '#' to the line's end. Thread-safe.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace tessera::core {

// Removes and returns the first line of `text`.
std::string_view take_line(std::string_view& text);
// The statements of an OBJ file: its lines, where a '\' at the end continues a line on the next. A comment
// is not continued.
class StatementLines {
 public:
  explicit StatementLines(std::string_view text) : rest_(text) {}

  // Advances to the next statement; returns false at the end of the text.
  bool next();
  // Valid until the next step.
  std::string_view line() const { return line_; }
  // The number of the statement's first line, from 1.
  int number() const { return number_; }

 private:
  void join();

  std::string_view rest_, line_;
  std::string joined_;
  int number_ = 0, lines_taken_ = 0;
};

// Removes and returns the first word of `line` with the blanks around it; empty at the end.
std::string_view take_word(std::string_view& line);
// Removes the byte order mark of UTF-8.
std::string_view without_byte_order_mark(std::string_view text);
void append_utf8(std::string& text, std::uint32_t code);
// Removes a byte order mark. UTF-16 text with a byte order mark is converted, into `converted`.
std::string_view as_utf8(std::string_view text, std::string& converted);
// Removes blanks at both ends.
std::string_view trimmed(std::string_view line);
// Removes a comment and the blanks before it. For names, which may contain '#', a comment starts with a
// word that begins with '#'.
std::string_view without_comment(std::string_view line);
std::string_view name_without_comment(std::string_view line);
// Removes double quotes that enclose the whole name.
std::string_view without_quotes(std::string_view name);

// A decimal number that fits a float, correctly rounded; nullopt for anything else, including NaN and
// infinity.
std::optional<float> parse_float(std::string_view word);
std::optional<int> parse_int(std::string_view word);

// The result of read_numbers().
struct Numbers {
  int count = 0;                // of finite numbers before the first other word
  int words = 0;                // of all words
  bool all_are_numbers = true;  // finite ones
};

// Reads the finite numbers of `line`, up to a comment, into `into`. Excess numbers are counted and dropped.
Numbers read_numbers(std::string_view line, std::span<float> into);

}  // namespace tessera::core
