// SPDX-License-Identifier: Apache-2.0
// How one input of a fuzzer holds several things: parts that begin with a line "==== NAME", after a first one
// without a name. A separator, and not lengths, so that what is inserted or removed in one part leaves the
// others whole, and so that seeds can be read and written by hand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::fuzz {

struct Part {
  std::string_view name, bytes;
};

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// At least one part; views into `input`. The line break before a separator belongs to it.
inline std::vector<Part> parts_of(std::string_view input) {
  constexpr std::string_view kSeparator = "\n==== ";
  std::vector<Part> parts;
  std::string_view name;
  for (;;) {
    const std::size_t end = input.find(kSeparator);
    parts.push_back({name, input.substr(0, end)});
    if (end == std::string_view::npos) return parts;
    input.remove_prefix(end + kSeparator.size());
    const std::size_t line = input.find('\n');
    name = input.substr(0, line);
    input.remove_prefix(line == std::string_view::npos ? input.size() : line + 1);
  }
}

}  // namespace tessera::fuzz
