// SPDX-License-Identifier: Apache-2.0
#include "client/text_width.hpp"

#include <clocale>
#include <cwchar>

namespace tessera::client {
namespace {

constexpr const char* kEllipsis = "…";

// wcwidth() and mbrtowc() follow the locale of the thread; this one makes them read UTF-8.
class Utf8Locale {
 public:
  Utf8Locale() : before_(::uselocale(utf8())) {}
  ~Utf8Locale() { ::uselocale(before_); }
  Utf8Locale(const Utf8Locale&) = delete;
  Utf8Locale& operator=(const Utf8Locale&) = delete;

 private:
  static locale_t utf8() {
    static const locale_t locale = ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
    return locale;
  }
  locale_t before_;
};

struct Character {
  std::size_t bytes = 1, columns = 1;
};

// The first character of a text that is not empty. A byte that is not UTF-8 counts as one column.
Character first_character(std::string_view text) {
  std::mbstate_t state{};
  wchar_t letter = 0;
  const std::size_t bytes = std::mbrtowc(&letter, text.data(), text.size(), &state);
  if (bytes == 0 || bytes > text.size()) return {};
  const int columns = ::wcwidth(letter);
  return {bytes, columns < 0 ? 1 : static_cast<std::size_t>(columns)};
}

}  // namespace

std::size_t text_width(std::string_view text) {
  const Utf8Locale locale;
  std::size_t columns = 0;
  while (!text.empty()) {
    const Character first = first_character(text);
    columns += first.columns;
    text.remove_prefix(first.bytes);
  }
  return columns;
}

std::string shortened(std::string_view text, std::size_t columns) {
  if (text_width(text) <= columns) return std::string(text);
  if (columns == 0) return "";
  const Utf8Locale locale;
  std::size_t kept = 0, used = 1;  // the ellipsis takes a column
  while (kept < text.size()) {
    const Character next = first_character(text.substr(kept));
    if (used + next.columns > columns) break;
    kept += next.bytes;
    used += next.columns;
  }
  return std::string(text.substr(0, kept)) + kEllipsis;
}

}  // namespace tessera::client
