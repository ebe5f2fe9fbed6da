// SPDX-License-Identifier: Apache-2.0
#include "core/base/suggestion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "core/base/printable.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kMaxShownLength = 80;
constexpr std::size_t kShownBeginning = 24;  // characters kept at the start of shortened names
constexpr std::size_t kMaxListed = 14;
constexpr std::size_t kMinBeginning = 4;  // of a name whose rest is missing

// Names that differ by more edits are not similar.
std::size_t likeness_limit(std::string_view name) {
  return std::max<std::size_t>(1, name.size() / 3);
}

std::string listing(const std::vector<std::string_view>& known) {
  if (known.empty() || known.size() > kMaxListed) return "";
  std::vector<std::string> shown;
  for (const auto name : known) shown.push_back(in_quotes(name));
  return fmt::format("; known {} {}", known.size() == 1 ? "is" : "are", fmt::join(shown, ", "));
}

bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> two_above, above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], two_above[j - 2] + 1);
    }
    two_above = above;
    above = row;
  }
  return above[b.size()];
}

std::optional<std::string_view> similar_name(std::string_view name,
                                             const std::vector<std::string_view>& known) {
  if (name.size() > kMaxShownLength) return std::nullopt;
  const auto distance = [&](std::string_view k) {
    return k.size() > kMaxShownLength ? kMaxShownLength : edit_distance(name, k);
  };
  const auto nearest =
      std::min_element(known.begin(), known.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
  if (nearest != known.end() && distance(*nearest) <= likeness_limit(name)) return *nearest;
  const auto begins = [&](std::string_view k) { return name.size() >= kMinBeginning && k.starts_with(name); };
  if (std::count_if(known.begin(), known.end(), begins) != 1) return std::nullopt;
  return *std::find_if(known.begin(), known.end(), begins);
}

std::string suggestion(std::string_view name, const std::vector<std::string_view>& known) {
  const auto similar = similar_name(name, known);
  return similar ? fmt::format("; did you mean {}?", in_quotes(*similar)) : listing(known);
}

std::string in_quotes(std::string_view name) {
  if (name.size() <= kMaxShownLength) return "'" + printable(name) + "'";
  // Cuts only between characters.
  std::size_t end = kShownBeginning, begin = name.size() - (kMaxShownLength - kShownBeginning);
  while (end > 0 && is_continuation(name[end])) --end;
  while (begin < name.size() && is_continuation(name[begin])) ++begin;
  return "'" + printable(name.substr(0, end)) + "..." + printable(name.substr(begin)) + "'";
}

}  // namespace tessera::core
