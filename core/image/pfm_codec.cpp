// SPDX-License-Identifier: Apache-2.0
// Portable float maps after Debevec: rows run from the bottom up, and a negative scale means little-endian.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>

#include "core/image/codec.hpp"

namespace tessera::core {
namespace pfm {
namespace {

struct PfmHeader {
  ImageSize size;
  std::size_t channels = 3;
  bool little_endian = true;
  std::string_view pixels;  // all bytes after the header
};

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// Takes the next word and one white space after it; empty if there is none. CR LF counts as one.
std::string_view take_word(std::string_view& text) {
  const auto begin = static_cast<std::size_t>(std::ranges::find_if_not(text, is_space) - text.begin());
  const std::size_t end = text.find_first_of(" \t\r\n", begin);
  if (end == std::string_view::npos) return {};
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end + (text.substr(end).starts_with("\r\n") ? 2 : 1));
  return word;
}

template <typename T>
bool parse_number(std::string_view word, T& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

std::optional<PfmHeader> parse_header(std::string_view bytes) {
  PfmHeader header;
  header.channels = take_word(bytes) == "PF" ? 3 : 1;
  double scale = 0;
  if (!parse_number(take_word(bytes), header.size.width) ||
      !parse_number(take_word(bytes), header.size.height) || !parse_number(take_word(bytes), scale) ||
      scale == 0)
    return std::nullopt;
  header.little_endian = scale < 0;
  header.pixels = bytes;
  return header;
}

bool matches(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == 'P' && (bytes[1] == 'F' || bytes[1] == 'f') && is_space(bytes[2]);
}

Result<ImageSize> read_size(std::string_view bytes) {
  const auto header = parse_header(bytes);
  if (!header) return broken_image("PFM", "its header is not a size and a scale");
  return header->size;
}

float load_float(const char* bytes, bool little_endian) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, bytes, sizeof bits);
  return std::bit_cast<float>(little_endian ? bits : __builtin_bswap32(bits));
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions&) {
  const auto header = parse_header(bytes);
  if (!header) return broken_image("PFM", "its header is not a size and a scale");
  const std::size_t channels = header->channels;
  const std::uint64_t expected = size.pixels() * channels * sizeof(float);
  if (header->pixels.size() != expected)
    return broken_image("PFM", fmt::format("{} x {} pixels take {} bytes, got {}", size.width, size.height,
                                           expected, header->pixels.size()));
  DecodedImage::Floats values;
  values.reserve(size.pixels() * 3);
  const std::size_t row_values = static_cast<std::size_t>(size.width) * channels;
  for (int y = size.height - 1; y >= 0; --y) {
    const char* row = header->pixels.data() + static_cast<std::size_t>(y) * row_values * sizeof(float);
    for (std::size_t i = 0; i < row_values; ++i)
      values.insert(values.end(), channels == 3 ? 1 : 3,
                    load_float(row + i * sizeof(float), header->little_endian));
  }
  return DecodedImage{.size = size, .channels = 3, .values = std::move(values), .warnings = {}};
}

}  // namespace
}  // namespace pfm

const Codec kPfmCodec{"PFM", true, pfm::matches, pfm::read_size, pfm::decode};

}  // namespace tessera::core
