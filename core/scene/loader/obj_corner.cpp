// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/obj_corner.hpp"

#include <algorithm>
#include <array>

namespace tessera::core {
namespace {

bool is_zero(std::string_view index) {
  return index.find_first_not_of("-0") == std::string_view::npos;
}

// Indices with more digits are out of range and would overflow int.
bool is_index(std::string_view index) {
  constexpr std::size_t kMaxDigits = 9;
  if (index.starts_with('-')) index.remove_prefix(1);
  return !index.empty() && index.size() <= kMaxDigits &&
         index.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

bool append_corner(std::string_view word, std::string& text) {
  constexpr std::size_t kParts = 3;
  std::array<std::string_view, kParts> parts;  // v, vt and vn
  std::size_t count = 0;
  for (;;) {
    if (count == kParts) return false;
    const std::size_t slash = std::min(word.find('/'), word.size());
    parts[count++] = word.substr(0, slash);
    if (slash == word.size()) break;
    word.remove_prefix(slash + 1);
  }
  if (!is_index(parts[0]) || is_zero(parts[0])) return false;
  for (std::size_t i = 1; i < count; ++i) {
    if (!parts[i].empty() && !is_index(parts[i])) return false;
    if (is_zero(parts[i])) parts[i] = {};
  }
  text += parts[0];
  if (!parts[1].empty() || !parts[2].empty()) (text += '/') += parts[1];
  if (!parts[2].empty()) (text += '/') += parts[2];
  return true;
}

}  // namespace tessera::core
