#include "core/scene/loader/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace tessera::core {
namespace {

constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

bool goes_on(std::string_view line) {
  return line.ends_with('\\') && line.find('#') == std::string_view::npos;
}

// In pieces, so that a file whose lines all end with '\r' is not searched to its end for a '\n' at each line.
std::size_t line_length(std::string_view text) {
  constexpr std::size_t kPiece = 4096;
  for (std::size_t begin = 0; begin < text.size(); begin += kPiece) {
    const std::string_view piece = text.substr(begin, kPiece);
    const std::size_t newline = piece.find('\n');
    const std::size_t end = std::min(newline, piece.substr(0, newline).find('\r'));
    if (end != std::string_view::npos) return begin + end;
  }
  return text.size();
}

}  // namespace

std::string_view take_line(std::string_view& text) {
  const std::size_t end = line_length(text);
  const std::string_view line = text.substr(0, end);
  const bool two = end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n';
  text.remove_prefix(end == text.size() ? end : end + (two ? 2 : 1));
  return line;
}

bool StatementLines::next() {
  if (rest_.empty()) return false;
  line_ = take_line(rest_);
  number_ = ++lines_taken_;
  if (goes_on(line_) && !rest_.empty()) join();
  return true;
}

void StatementLines::join() {
  joined_.clear();
  while (goes_on(line_) && !rest_.empty()) {
    joined_ += line_.substr(0, line_.size() - 1);
    joined_ += ' ';
    line_ = take_line(rest_);
    ++lines_taken_;
  }
  joined_ += line_;
  line_ = joined_;
}

std::string_view take_word(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  while (end < line.size() && is_blank(line[end])) ++end;
  line.remove_prefix(end);
  return word;
}

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
  return line;
}

std::string_view without_comment(std::string_view line) {
  return trimmed(line.substr(0, line.find('#')));
}

std::string_view name_without_comment(std::string_view line) {
  for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1))
    if (at == 0 || is_blank(line[at - 1])) return trimmed(line.substr(0, at));
  return trimmed(line);
}

std::optional<float> parse_float(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  float value = 0;
  auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) {
    // Too large, or so small that it is 0.
    double wide = 0;
    error = std::from_chars(word.data(), word.data() + word.size(), wide).ec;
    if (std::fabs(wide) > 1) return std::nullopt;
    value = static_cast<float>(wide);
  }
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<int> parse_int(std::string_view word) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<int> read_numbers(std::string_view line, std::span<float> into, int most) {
  line = without_comment(line);
  int count = 0;
  for (auto word = take_word(line); !word.empty(); word = take_word(line), ++count) {
    const auto number = parse_float(word);
    if (!number || count == most) return std::nullopt;
    if (static_cast<std::size_t>(count) < into.size()) into[static_cast<std::size_t>(count)] = *number;
  }
  return count;
}

}  // namespace tessera::core
