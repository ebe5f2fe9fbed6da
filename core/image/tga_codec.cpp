// SPDX-License-Identifier: Apache-2.0
// Truevision TGA: all pixel types, run-length encoding and orientations of the specification 2.0 (1991).
#include <array>
#include <cstring>
#include <optional>

#include "core/image/codec.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {
namespace tga {
namespace {

constexpr std::size_t kHeaderBytes = 18;
enum Kind : unsigned { kPalette = 1, kColor = 2, kGray = 3 };
constexpr unsigned kRunLengths = 8;  // flag in the image type
using Rgba = std::array<std::uint8_t, 4>;

struct TgaHeader {
  unsigned kind = 0, pixel_bits = 0, palette_bits = 0, alpha_bits = 0;
  std::size_t palette_first = 0, palette_size = 0, palette_offset = 0;
  bool run_lengths = false, from_right = false, from_top = false;
  ImageSize size;

  std::size_t pixel_bytes() const { return (pixel_bits + 7) / 8; }
  std::size_t palette_entry_bytes() const { return (palette_bits + 7) / 8; }
  std::size_t pixel_offset() const { return palette_offset + palette_size * palette_entry_bytes(); }
};

bool is_color_depth(unsigned bits) {
  return bits == 15 || bits == 16 || bits == 24 || bits == 32;
}

bool is_valid(const TgaHeader& header) {
  if (header.kind == kPalette)
    return (header.pixel_bits == 8 || header.pixel_bits == 16) && is_color_depth(header.palette_bits) &&
           header.palette_size > 0;
  if (header.kind == kGray) return header.pixel_bits == 8 || header.pixel_bits == 16;
  return header.kind == kColor && is_color_depth(header.pixel_bits);
}

std::optional<TgaHeader> parse_header(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes || byte_at(bytes, 1) > 1) return std::nullopt;
  const unsigned kind = byte_at(bytes, 2), descriptor = byte_at(bytes, 17);
  if ((kind & ~(3u | kRunLengths)) != 0 || (descriptor & 0xc0) != 0) return std::nullopt;
  const bool has_palette = byte_at(bytes, 1) == 1;
  const TgaHeader header{
      .kind = kind & 3u,
      .pixel_bits = byte_at(bytes, 16),
      .palette_bits = has_palette ? byte_at(bytes, 7) : 0,
      .alpha_bits = descriptor & 15u,
      .palette_first = little_endian_16(bytes, 3),
      .palette_size = has_palette ? little_endian_16(bytes, 5) : 0,
      .palette_offset = kHeaderBytes + byte_at(bytes, 0),
      .run_lengths = (kind & kRunLengths) != 0,
      .from_right = (descriptor & 0x10) != 0,
      .from_top = (descriptor & 0x20) != 0,
      .size = {static_cast<int>(little_endian_16(bytes, 12)), static_cast<int>(little_endian_16(bytes, 14))}};
  if (!is_valid(header)) return std::nullopt;
  return header;
}

bool matches(std::string_view bytes) {
  const auto header = parse_header(bytes);
  return header && header->size.pixels() > 0;
}

Result<ImageSize> read_size(std::string_view bytes) {
  return parse_header(bytes)->size;
}

// Pixels are stored as blue, green, red and alpha; 15 and 16 bits have 5 bits per colour.
Rgba color_of(std::string_view bytes, std::size_t at, unsigned bits, unsigned alpha_bits) {
  const auto code = [](unsigned value) { return static_cast<std::uint8_t>(value); };
  if (bits >= 24)
    return {code(byte_at(bytes, at + 2)), code(byte_at(bytes, at + 1)), code(byte_at(bytes, at)),
            code(bits == 32 ? byte_at(bytes, at + 3) : 255)};
  const unsigned word = little_endian_16(bytes, at);
  const auto five_bits = [&](unsigned shift) { return code(((word >> shift & 31) * 255 + 15) / 31); };
  const bool opaque = bits == 15 || alpha_bits == 0 || (word & 0x8000) != 0;
  return {five_bits(10), five_bits(5), five_bits(0), code(opaque ? 255 : 0)};
}

Rgba palette_color(std::string_view bytes, const TgaHeader& header, std::size_t index) {
  if (index < header.palette_first || index - header.palette_first >= header.palette_size)
    return {0, 0, 0, 255};
  const std::size_t at =
      header.palette_offset + (index - header.palette_first) * header.palette_entry_bytes();
  return color_of(bytes, at, header.palette_bits, header.alpha_bits);
}

// The colour of the pixel at offset `at`.
Rgba pixel_color(std::string_view bytes, const TgaHeader& header, std::size_t at) {
  if (header.kind == kColor) return color_of(bytes, at, header.pixel_bits, header.alpha_bits);
  const bool wide = header.pixel_bits == 16;
  if (header.kind == kPalette)
    return palette_color(bytes, header, wide ? little_endian_16(bytes, at) : byte_at(bytes, at));
  const auto gray = static_cast<std::uint8_t>(byte_at(bytes, at));
  return {gray, gray, gray, static_cast<std::uint8_t>(wide ? byte_at(bytes, at + 1) : 255)};
}

// Reads pixels in file order; returns false if the file ends early.
class PixelReader {
 public:
  PixelReader(std::string_view bytes, const TgaHeader& header)
      : bytes_(bytes), header_(header), at_(header.pixel_offset()) {}

  bool next(Rgba& color) {
    if (header_.run_lengths && left_ == 0) {
      if (at_ >= bytes_.size()) return false;
      const unsigned packet = byte_at(bytes_, at_++);
      repeats_ = (packet & 128) != 0;
      left_ = (packet & 127) + 1;
      is_first_ = true;
    }
    if (!header_.run_lengths || !repeats_ || is_first_) {
      if (at_ + header_.pixel_bytes() > bytes_.size()) return false;
      color_ = pixel_color(bytes_, header_, at_);
      at_ += header_.pixel_bytes();
      is_first_ = false;
    }
    if (left_ > 0) --left_;
    color = color_;
    return true;
  }

 private:
  std::string_view bytes_;
  const TgaHeader& header_;
  std::size_t at_;
  unsigned left_ = 0;  // remaining pixels of the packet
  bool repeats_ = false, is_first_ = false;
  Rgba color_{};
};

// Many programs write alpha 0 everywhere in files that are meant to be opaque.
bool is_transparent_everywhere(const DecodedImage::Bytes& rgba) {
  for (std::size_t i = 3; i < rgba.size(); i += 4)
    if (rgba[i] != 0) return false;
  return true;
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions& options) {
  const TgaHeader header = *parse_header(bytes);
  if (header.pixel_offset() > bytes.size() || !is_plausible_size(size.width, size.height, bytes.size()))
    return broken_image("TGA", kEndsTooEarly);
  DecodedImage::Bytes values(4 * size.pixels());
  PixelReader pixels(bytes, header);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      const int x = header.from_right ? size.width - 1 - column : column;
      const int y = header.from_top ? row : size.height - 1 - row;
      Rgba color;
      if (!pixels.next(color)) return broken_image("TGA", kEndsTooEarly);
      std::memcpy(&values[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                               static_cast<std::size_t>(x))],
                  color.data(), color.size());
    }
  const bool keep_alpha = options.keep_alpha && !is_transparent_everywhere(values);
  if (!keep_alpha) drop_alpha(values);
  return DecodedImage{
      .size = size, .channels = keep_alpha ? 4u : 3u, .values = std::move(values), .warnings = {}};
}

}  // namespace
}  // namespace tga

const Codec kTgaCodec{"TGA", false, tga::matches, tga::read_size, tga::decode};

}  // namespace tessera::core
