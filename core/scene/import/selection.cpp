// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// "0 ('Front'), 1"
std::string list_of_names(std::span<const std::string> names) {
  constexpr std::size_t kMaxListed = 20;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxListed); ++i) {
    list += fmt::format("{}{}", i == 0 ? "" : ", ", i);
    if (!names[i].empty()) list += fmt::format(" ({})", in_quotes(names[i]));
  }
  return names.size() > kMaxListed ? list + ", ..." : list;
}

}  // namespace

Result<std::size_t> find_selected(std::string_view what, std::string_view wanted,
                                  std::span<const std::string> names) {
  const auto named = std::find(names.begin(), names.end(), wanted);
  if (named != names.end() && !wanted.empty()) return static_cast<std::size_t>(named - names.begin());
  std::size_t index = 0;
  const char* const end = wanted.data() + wanted.size();
  const auto [stop, error] = std::from_chars(wanted.data(), end, index);
  if (!wanted.empty() && error == std::errc() && stop == end && index < names.size()) return index;
  return mistake(fmt::format("there is no {} {}; {}", what, in_quotes(wanted),
                             names.empty() ? "the file has none" : "the file has " + list_of_names(names)));
}

Error unused_parameter(std::string_view name, const std::vector<std::string_view>& used) {
  return {ErrorCode::kInvalidArgument, fmt::format("{}: nothing in the scene uses a parameter of this name{}",
                                                   printable(name), suggestion(name, used))};
}

}  // namespace tessera::core
