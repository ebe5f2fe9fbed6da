// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/file_names.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/letter_case.hpp"
#include "core/base/printable.hpp"
#include "core/scene/loader/text_lines.hpp"

namespace tessera::core {
namespace {

// The characters 0x80 to 0x9f of Windows-1252. Those that it does not define stay control characters.
constexpr std::array<char16_t, 32> kWindows1252{
    0x20ac, 0x0081, 0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0x008d, 0x017d, 0x008f, 0x0090, 0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0x009d, 0x017e, 0x0178};

int hexadecimal(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool is_ascii(char c) {
  return static_cast<unsigned char>(c) < 0x80;
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

// The bytes of the combining marks U+0300 to U+036F at the beginning.
std::size_t combining_marks(std::string_view text) {
  std::size_t bytes = 0;
  while (text.size() - bytes >= 2 &&
         (text[bytes] == '\xcc' || (text[bytes] == '\xcd' && text[bytes + 1] <= '\xaf')))
    bytes += 2;
  return bytes;
}

// The bytes of the ASCII letter with combining marks at the beginning; 0 if there is none.
std::size_t decomposed_letter(std::string_view text) {
  if (text.empty() || !is_letter(text[0])) return 0;
  const std::size_t marks = combining_marks(text.substr(1));
  return marks == 0 ? 0 : 1 + marks;
}

// The bytes of the character beyond ASCII at the beginning; 0 if there is none.
std::size_t composed_letter(std::string_view text) {
  if (text.empty() || is_ascii(text[0])) return 0;
  std::size_t bytes = 1;
  while (bytes < text.size() && is_continuation(text[bytes])) ++bytes;
  return bytes;
}

// Removes an accented letter from both, if they write it differently.
bool take_accented(std::string_view& composed, std::string_view& decomposed) {
  const std::size_t one = composed_letter(composed), several = decomposed_letter(decomposed);
  if (one == 0 || several == 0) return false;
  composed.remove_prefix(one);
  decomposed.remove_prefix(several);
  return true;
}

}  // namespace

std::string decode_percent(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && text.size() - i > 2 ? hexadecimal(text[i + 1]) : -1;
    const int low = high < 0 ? -1 : hexadecimal(text[i + 2]);
    if (low >= 0) i += 2;
    bytes.push_back(low < 0 ? text[i] : static_cast<char>(16 * high + low));
  }
  return bytes;
}

std::optional<std::string> windows_1252_as_utf8(std::string_view name) {
  if (is_printable(name)) return std::nullopt;
  std::string text;
  for (const char c : name) {
    const auto code = static_cast<unsigned char>(c);
    append_utf8(text, code >= 0x80 && code < 0xa0 ? kWindows1252[code - 0x80] : code);
  }
  return text;
}

bool are_same_names(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (take_accented(a, b) || take_accented(b, a)) continue;
    if (!equal_ignoring_case(a.substr(0, 1), b.substr(0, 1))) return false;
    a.remove_prefix(1);
    b.remove_prefix(1);
  }
  return a.empty() && b.empty();
}

std::string spelling_key(std::string_view name) {
  std::string key;
  while (!name.empty()) {
    const std::size_t accented = std::max(composed_letter(name), decomposed_letter(name));
    key += accented > 0 ? std::string(1, '?') : in_lower_case(name.substr(0, 1));
    name.remove_prefix(std::max<std::size_t>(accented, 1));
  }
  return key;
}

}  // namespace tessera::core
