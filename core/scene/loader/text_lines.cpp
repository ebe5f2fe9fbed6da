// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <system_error>

namespace tessera::core {
namespace {

bool has_negative_exponent(std::string_view number) {
  return number.find("e-") != std::string_view::npos || number.find("E-") != std::string_view::npos;
}

// Some programs pad files with Ctrl-Z and NUL bytes.
constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0' || c == '\x1a';
}

bool survives(std::string_view line) {
  return line.ends_with('\\') && line.find('#') == std::string_view::npos;
}

// Searches in pieces, so that a file whose lines all end with '\r' is not searched to its end for a '\n' at
// each line.
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

// RFC 2781, section 2.2. Unpaired surrogates become the replacement character.
std::string from_utf16(std::string_view bytes, bool big_endian) {
  constexpr std::uint32_t kReplacement = 0xfffd;
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<std::uint8_t>(bytes[2 * i]);
    const auto second = static_cast<std::uint8_t>(bytes[2 * i + 1]);
    return std::uint32_t{big_endian ? first : second} << 8 | (big_endian ? second : first);
  };
  const std::size_t units = bytes.size() / 2;
  std::string text;
  text.reserve(units);
  for (std::size_t i = 0; i < units; ++i) {
    const std::uint32_t first = unit(i);
    const std::uint32_t second = i + 1 < units ? unit(i + 1) : 0;
    const bool is_surrogate = first >> 11 == 0x1b;
    if (first >> 10 == 0x36 && second >> 10 == 0x37) {
      append_utf8(text, 0x10000 + ((first & 0x3ff) << 10 | (second & 0x3ff)));
      ++i;
    } else {
      append_utf8(text, is_surrogate ? kReplacement : first);
    }
  }
  return text;
}

}  // namespace

void append_utf8(std::string& text, std::uint32_t code) {
  const auto continuation = [](std::uint32_t bits) { return static_cast<char>(0x80 | (bits & 0x3f)); };
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += {static_cast<char>(0xc0 | code >> 6), continuation(code)};
  } else if (code < 0x10000) {
    text += {static_cast<char>(0xe0 | code >> 12), continuation(code >> 6), continuation(code)};
  } else {
    text += {static_cast<char>(0xf0 | code >> 18), continuation(code >> 12), continuation(code >> 6),
             continuation(code)};
  }
}

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
  if (survives(line_) && !rest_.empty()) join();
  return true;
}

void StatementLines::join() {
  joined_.clear();
  while (survives(line_) && !rest_.empty()) {
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
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

std::string_view as_utf8(std::string_view text, std::string& converted) {
  const bool little_endian = text.starts_with("\xff\xfe"), big_endian = text.starts_with("\xfe\xff");
  if (!little_endian && !big_endian) return without_byte_order_mark(text);
  converted = from_utf16(text.substr(2), big_endian);
  return converted;
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

std::string_view without_quotes(std::string_view name) {
  if (name.size() > 2 && name.front() == '"' && name.back() == '"') return name.substr(1, name.size() - 2);
  return name;
}

std::optional<float> parse_float(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  float value = 0;
  auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) {
    // The number overflows, or underflows to 0.
    double wide = 0;
    error = std::from_chars(word.data(), word.data() + word.size(), wide).ec;
    if (error == std::errc::result_out_of_range && has_negative_exponent(word)) error = std::errc();
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

Numbers read_numbers(std::string_view line, std::span<float> into) {
  line = without_comment(line);
  Numbers numbers;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) {
    const auto number = parse_float(word);
    numbers.all_are_numbers = numbers.all_are_numbers && number;
    const auto i = static_cast<std::size_t>(numbers.words++);
    if (number && i < into.size()) into[i] = *number;
    if (numbers.all_are_numbers) ++numbers.count;
  }
  return numbers;
}

}  // namespace tessera::core
