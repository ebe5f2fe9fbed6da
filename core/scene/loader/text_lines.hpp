// SPDX-License-Identifier: Apache-2.0
// Lines and words of OBJ and MTL files: a line ends with \n, \r\n or \r, words are separated by
// blanks, a comment goes from '#' to the line's end. Thread-safe.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace tessera::core {

// The first line of `text`, which is taken off it.
std::string_view take_line(std::string_view& text);
// The statements of an OBJ file: its lines, of which one that ends with '\' goes on in the next. A comment
// does not go on.
class StatementLines {
 public:
  explicit StatementLines(std::string_view text) : rest_(text) {}

  // Steps to the next line; false at the end of the text.
  bool next();
  // Valid until the next step.
  std::string_view line() const { return line_; }
  // From 1; of several lines that are one statement, the first's.
  int number() const { return number_; }

 private:
  void join();

  std::string_view rest_, line_;
  std::string joined_;
  int number_ = 0, lines_taken_ = 0;
};

// The first word of `line`, which is taken off it with the blanks around it; empty at the end.
std::string_view take_word(std::string_view& line);
// Without a byte order mark. Text that begins with one of UTF-16 is converted, into `converted`.
std::string_view as_utf8(std::string_view text, std::string& converted);
// Without blanks at either end.
std::string_view trimmed(std::string_view line);
// Without a comment and the blanks before it. For names, in which '#' is part of a word, a comment is a word
// that begins with '#'.
std::string_view without_comment(std::string_view line);
std::string_view name_without_comment(std::string_view line);
// Without double quotes around all of it.
std::string_view without_quotes(std::string_view name);

// A decimal number that fits a float, correctly rounded; nullopt for anything else, NaN and infinity among
// it.
std::optional<float> parse_float(std::string_view word);
std::optional<int> parse_int(std::string_view word);

// What read_numbers() found.
struct Numbers {
  int count = 0;                // of finite numbers before anything else
  int words = 0;                // of everything
  bool all_are_numbers = true;  // finite ones
};

// Reads the finite numbers of `line`, up to a comment, into their places in `into`. Those beyond its end are
// counted and dropped.
Numbers read_numbers(std::string_view line, std::span<float> into);

}  // namespace tessera::core
