// SPDX-License-Identifier: Apache-2.0
#include "core/image/hdr_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace tessera::core {
namespace {

constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 16;

tl::unexpected<Error> refuse(std::string why) {
  return fail(ErrorCode::kInvalidArgument, std::move(why));
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

// Returns nothing at the end of the header's text.
std::optional<std::string_view> take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return trimmed(line);
}

std::string_view take_word(std::string_view& line) {
  line = trimmed(line);
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line.remove_prefix(word.size());
  return word;
}

struct Axis {
  char name = 0, sign = 0;
  int pixels = 0;
};

std::optional<Axis> take_axis(std::string_view& line) {
  const std::string_view direction = take_word(line), number = take_word(line);
  if (direction.size() != 2 || (direction[0] != '+' && direction[0] != '-')) return std::nullopt;
  Axis axis{.name = static_cast<char>(direction[1] & ~0x20), .sign = direction[0]};
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), axis.pixels);
  if (error != std::errc() || end != number.data() + number.size()) return std::nullopt;
  return axis;
}

// "-Y 32 +X 64": the file has 32 rows from the top down, each of 64 pixels from the left.
bool parse_size(std::string_view line, HdrHeader& header) {
  const auto outer = take_axis(line), inner = take_axis(line);
  if (!outer || !inner || !trimmed(line).empty()) return false;
  header.is_by_columns = outer->name == 'X';
  const Axis &x = header.is_by_columns ? *outer : *inner, &y = header.is_by_columns ? *inner : *outer;
  if (x.name != 'X' || y.name != 'Y') return false;
  header.width = x.pixels;
  header.height = y.pixels;
  header.from_right = x.sign == '-';
  header.from_bottom = y.sign == '+';
  return true;
}

// Variables that do not affect the pixels are ignored.
Status note_variable(std::string_view line, HdrHeader& header) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || line.starts_with('#')) return {};
  const std::string_view name = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
  if (name == "FORMAT") {
    header.is_xyz = value == "32-bit_rle_xyze";
    if (!header.is_xyz && value != "32-bit_rle_rgbe")
      return refuse("its FORMAT is not 32-bit_rle_rgbe or 32-bit_rle_xyze");
  } else if (name == "EXPOSURE") {
    double exposure = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), exposure);
    header.exposure *= exposure;
    if (error != std::errc() || !(header.exposure > 0) || !std::isfinite(header.exposure))
      return refuse("its EXPOSURE is not a positive number");
  } else if (name == "PRIMARIES") {
    header.has_primaries = true;
  } else if (name == "COLORCORR") {
    header.has_color_correction = true;
  }
  return {};
}

}  // namespace

// The blank line before the size may be missing.
Result<HdrHeader> parse_hdr_header(std::string_view bytes) {
  HdrHeader header;
  std::string_view text = bytes.substr(0, kMaxHeaderBytes);
  while (const auto line = take_line(text)) {
    if (parse_size(*line, header)) {
      header.pixel_offset = std::min(bytes.size(), kMaxHeaderBytes) - text.size();
      return header;
    }
    if (const Status status = note_variable(*line, header); !status) return fail(status.error());
  }
  return refuse("it has no line that tells its size, such as -Y 512 +X 1024");
}

}  // namespace tessera::core
