// SPDX-License-Identifier: Apache-2.0
#include "client/duration.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <system_error>
#include <utility>

namespace tessera::client {

std::optional<double> parse_duration(std::string_view text) {
  constexpr std::array<std::pair<char, double>, 4> kUnits{{{'d', 86400}, {'h', 3600}, {'m', 60}, {'s', 1}}};
  constexpr double kMaxSeconds = 1000.0 * 86400;
  if (text.empty()) return std::nullopt;
  double seconds = 0;
  auto unit = kUnits.begin();
  while (!text.empty()) {
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (error != std::errc() || text.empty()) return std::nullopt;
    while (unit != kUnits.end() && unit->first != text.front()) ++unit;
    if (unit == kUnits.end()) return std::nullopt;
    seconds += number * unit->second;
    ++unit;
    text.remove_prefix(1);
  }
  if (seconds > kMaxSeconds) return std::nullopt;
  return seconds;
}

}  // namespace tessera::client
