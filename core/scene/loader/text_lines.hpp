// Lines and words of OBJ and MTL files: a line ends with \n, \r\n or \r, words are parted by spaces and tabs,
// a comment goes from '#' to the line's end. Thread-safe.
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
// Without the three bytes that some editors put in front of UTF-8.
std::string_view without_byte_order_mark(std::string_view text);
// Without blanks at either end.
std::string_view trimmed(std::string_view line);
// Without a comment and the blanks before it. For names, in which '#' is part of a word, a comment is a word
// that begins with '#'.
std::string_view without_comment(std::string_view line);
std::string_view name_without_comment(std::string_view line);

// A decimal number that fits a float, correctly rounded; nullopt for anything else, NaN and infinity among
// it.
std::optional<float> parse_float(std::string_view word);
std::optional<int> parse_int(std::string_view word);

// Reads the numbers of `line`, up to a comment, into `into`; how many there are, or nullopt where something
// else stands among them or there are more than `most`. Numbers beyond the end of `into` are checked and
// dropped.
std::optional<int> read_numbers(std::string_view line, std::span<float> into, int most);

}  // namespace tessera::core
