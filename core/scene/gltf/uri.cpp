// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/uri.hpp"

#include <array>
#include <cstdint>

#include "core/scene/loader/file_names.hpp"

namespace tessera::core::gltf {
namespace {

constexpr std::uint8_t kNoDigit = 64;

// The values of base64's digits (Josefsson 2006, tables 1 and 2).
constexpr std::array<std::uint8_t, 256> kBase64 = [] {
  std::array<std::uint8_t, 256> values{};
  values.fill(kNoDigit);
  std::uint8_t next = 0;
  for (char c = 'A'; c <= 'Z'; ++c) values[static_cast<unsigned char>(c)] = next++;
  for (char c = 'a'; c <= 'z'; ++c) values[static_cast<unsigned char>(c)] = next++;
  for (char c = '0'; c <= '9'; ++c) values[static_cast<unsigned char>(c)] = next++;
  values['+'] = values['-'] = 62;
  values['/'] = values['_'] = 63;
  return values;
}();

// Line breaks and blanks have no meaning.
std::optional<std::string> decode_base64(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n", kPadding = "= \t\r\n";
  text = text.substr(0, text.find_last_not_of(kPadding) + 1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    if (kBlanks.find(c) != std::string_view::npos) continue;
    const std::uint8_t digit = kBase64[static_cast<unsigned char>(c)];
    if (digit == kNoDigit) return std::nullopt;
    bits = (bits << 6 | digit) & 0xffff;
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes.push_back(static_cast<char>(bits >> bit_count & 0xff));
  }
  return bytes;
}

}  // namespace

std::optional<std::string> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  const std::string_view data = uri.substr(comma + 1);
  return uri.substr(0, comma).ends_with(";base64") ? decode_base64(data) : decode_percent(data);
}

bool has_scheme(std::string_view uri) {
  return uri.find("://") != std::string_view::npos && !uri.starts_with("file:");
}

}  // namespace tessera::core::gltf
