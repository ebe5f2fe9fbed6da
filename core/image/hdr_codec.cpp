// SPDX-License-Identifier: Apache-2.0
// Decodes Radiance HDR files after Ward, "Real Pixels", Graphics Gems II (1991), and Radiance's manual of
// file formats: RGBE pixels, flat or with either kind of run-length encoding, in eight orientations.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/image/codec.hpp"
#include "core/image/hdr_header.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {
namespace hdr {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

// A line is a row of the file, or a column. Lines outside these lengths are never packed by channel.
constexpr int kMinPackedPixels = 8, kMaxPackedPixels = 32767;

class LineReader {
 public:
  LineReader(std::string_view data, int pixels) : data_(data), line_(static_cast<std::size_t>(pixels)) {}

  // Returns an empty string on success, else the error.
  std::string_view read() { return begins_packed() ? read_packed() : read_flat(); }
  const std::vector<Rgbe>& line() const { return line_; }

 private:
  bool begins_packed() const {
    const auto pixels = static_cast<int>(line_.size());
    return pixels >= kMinPackedPixels && pixels <= kMaxPackedPixels && data_.size() >= 4 &&
           byte_at(data_, 0) == 2 && byte_at(data_, 1) == 2 && byte_at(data_, 2) < 128;
  }

  // Two marker bytes, the length, and the run lengths of each channel.
  std::string_view read_packed() {
    if (byte_at(data_, 2) * 256 + byte_at(data_, 3) != line_.size()) return "a row has another length";
    data_.remove_prefix(4);
    for (std::size_t channel = 0; channel < 4; ++channel)
      if (const auto fault = read_channel(channel); !fault.empty()) return fault;
    return {};
  }

  std::string_view read_channel(std::size_t channel) {
    for (std::size_t x = 0; x < line_.size();) {
      if (data_.size() < 2) return kEndsTooEarly;
      const unsigned count = byte_at(data_, 0);
      const bool repeats = count > 128;
      const std::size_t pixels = repeats ? count - 128 : count;
      if (pixels == 0 || pixels > line_.size() - x) return "a run is longer than its row";
      if (data_.size() < (repeats ? 2 : 1 + pixels)) return kEndsTooEarly;
      for (std::size_t i = 0; i < pixels; ++i, ++x)
        line_[x][channel] = static_cast<std::uint8_t>(byte_at(data_, repeats ? 1 : 1 + i));
      data_.remove_prefix(repeats ? 2 : 1 + pixels);
    }
    return {};
  }

  // A flat sequence of pixels. Mantissas (1, 1, 1) repeat the previous pixel; consecutive repeats give the
  // bytes of a count, lowest first.
  std::string_view read_flat() {
    unsigned shift = 0;
    for (std::size_t x = 0; x < line_.size();) {
      if (data_.size() < 4) return kEndsTooEarly;
      Rgbe pixel;
      for (std::size_t i = 0; i < 4; ++i) pixel[i] = static_cast<std::uint8_t>(byte_at(data_, i));
      data_.remove_prefix(4);
      if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
        line_[x++] = previous_ = pixel;
        shift = 0;
        continue;
      }
      const std::size_t count = shift < 32 ? std::size_t{pixel[3]} << shift : 0;
      if (count > line_.size() - x) return "a run is longer than its row";
      for (std::size_t i = 0; i < count; ++i) line_[x++] = previous_;
      shift += 8;
    }
    return {};
  }

  std::string_view data_;
  std::vector<Rgbe> line_;
  Rgbe previous_{};
};

// The values of a pixel before division by the exposure.
std::array<float, 3> values_of(const Rgbe& pixel) {
  constexpr int kBias = 128 + 8;
  if (pixel[3] == 0) return {};
  const float unit = std::ldexp(1.0f, pixel[3] - kBias);
  return {static_cast<float>(pixel[0]) * unit, static_cast<float>(pixel[1]) * unit,
          static_cast<float>(pixel[2]) * unit};
}

// Converts XYZ to linear sRGB (IEC 61966-2-1:1999, D65 white).
std::array<float, 3> srgb_of_xyz(const std::array<float, 3>& xyz) {
  constexpr std::array<std::array<double, 3>, 3> kMatrix{{{3.2406255, -1.5372080, -0.4986286},
                                                          {-0.9689307, 1.8757561, 0.0415175},
                                                          {0.0557101, -0.2040211, 1.0569959}}};
  std::array<float, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += kMatrix[i][k] * static_cast<double>(xyz[k]);
    rgb[i] = static_cast<float>(sum);
  }
  return rgb;
}

std::array<float, 3> color_of(const Rgbe& pixel, const HdrHeader& header) {
  std::array<float, 3> color = values_of(pixel);
  if (header.is_xyz) color = srgb_of_xyz(color);
  if (header.exposure == 1) return color;
  for (float& value : color) value = static_cast<float>(static_cast<double>(value) / header.exposure);
  return color;
}

bool matches(std::string_view bytes) {
  return bytes.starts_with("#?") || bytes.starts_with("FORMAT=32-bit_rle_");
}

Result<ImageSize> read_size(std::string_view bytes) {
  const auto header = parse_hdr_header(bytes);
  if (!header) return broken_image("HDR", header.error().message);
  return ImageSize{header->width, header->height};
}

std::vector<std::string> warnings_of(const HdrHeader& header) {
  std::vector<std::string> warnings;
  if (header.has_primaries) warnings.push_back("is an HDR image whose PRIMARIES are ignored");
  if (header.has_color_correction) warnings.push_back("is an HDR image whose COLORCORR is ignored");
  return warnings;
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions&) {
  const auto header = parse_hdr_header(bytes);
  if (!header) return broken_image("HDR", header.error().message);
  if (!is_plausible_size(size.width, size.height, bytes.size()))
    return broken_image("HDR", implausible_size(size.width, size.height));
  DecodedImage::Floats values(3 * size.pixels());
  const int lines = header->is_by_columns ? size.width : size.height;
  const int line_pixels = header->is_by_columns ? size.height : size.width;
  LineReader reader(bytes.substr(header->pixel_offset), line_pixels);
  for (int line = 0; line < lines; ++line) {
    if (const auto fault = reader.read(); !fault.empty()) return broken_image("HDR", fault);
    for (int i = 0; i < line_pixels; ++i) {
      const int column = header->is_by_columns ? line : i, row = header->is_by_columns ? i : line;
      const int x = header->from_right ? size.width - 1 - column : column;
      const int y = header->from_bottom ? size.height - 1 - row : row;
      const auto color = color_of(reader.line()[static_cast<std::size_t>(i)], *header);
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
      std::copy(color.begin(), color.end(), values.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
    }
  }
  return DecodedImage{
      .size = size, .channels = 3, .values = std::move(values), .warnings = warnings_of(*header)};
}

}  // namespace
}  // namespace hdr

const Codec kHdrCodec{"HDR", true, hdr::matches, hdr::read_size, hdr::decode};

}  // namespace tessera::core
