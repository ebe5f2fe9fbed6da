// SPDX-License-Identifier: Apache-2.0
// The interface that every image decoder of this folder implements. Other code calls decode_pixels()
// (codecs.hpp).
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

struct ImageSize {
  int width = 0, height = 0;

  std::uint64_t pixels() const {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  }
};

// The CIE 1931 chromaticities x and y of a file's red, green, blue and white.
using PrimaryCoordinates = std::array<float, 8>;

// The pixels of a file in the file's precision.
struct DecodedImage {
  using Bytes = std::vector<std::uint8_t>;   // codes in [0, 255]
  using Words = std::vector<std::uint16_t>;  // codes in [0, 65535]
  using Floats = std::vector<float>;         // linear values; they may be negative, infinite or NaN

  ImageSize size;
  std::size_t channels = 3;                   // R, G, B; with 4, A follows and is not premultiplied
  std::variant<Bytes, Words, Floats> values;  // `channels` per pixel, row-major from the top left
  std::vector<std::string> warnings;          // oddities of the file, and how they were read
  // Of linear values; nullopt for those of Rec. 709.
  std::optional<PrimaryCoordinates> primaries{};

  bool is_linear() const { return std::holds_alternative<Floats>(values); }
};

struct DecodeOptions {
  std::int64_t max_pixels = 0;
  // Whether the result has 4 channels if the file has alpha. If not, it always has 3.
  bool keep_alpha = false;
  // Of an OpenEXR file, the layer to read ("Normal"), or a channel of it in all three colours ("Depth.Z").
  // Empty: the image itself; without colours, the first layer, with a warning. Other formats have no layers,
  // which is an error.
  std::string_view layer{};
};

// A file format. Error messages of its functions complete a sentence that begins with the file's name.
// Functions may throw std::bad_alloc, and nothing else.
struct Codec {
  std::string_view name;                    // as in "is a broken PNG image"
  bool is_linear;                           // whether every file of the format has linear values
  bool (*matches)(std::string_view bytes);  // recognises the format by the first bytes
  Result<ImageSize> (*read_size)(std::string_view bytes);
  // `size` is that of read_size(); it is within the limits of DecodeOptions.
  Result<DecodedImage> (*decode)(std::string_view bytes, ImageSize size, const DecodeOptions& options);
};

extern const Codec kPngCodec, kJpegCodec, kHdrCodec, kExrCodec, kPfmCodec, kTiffCodec, kWebpCodec, kBmpCodec,
    kQoiCodec, kTgaCodec;

inline constexpr std::string_view kEndsTooEarly = "the file ends too early";

inline tl::unexpected<Error> broken_image(std::string_view format, std::string_view why) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("is a broken {} image ({})", format, why));
}

inline tl::unexpected<Error> unsupported_image(std::string_view what, std::string_view remedy) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("is {}, which is not supported; {}", what, remedy));
}

// The error message for a file whose size is_plausible_size() (limits.hpp) rejects.
inline std::string implausible_size(std::int64_t width, std::int64_t height) {
  return fmt::format("its size of {}x{} pixels is not plausible for a file of its length", width, height);
}

// Readers of integers at byte offset `at` of a file.
inline unsigned byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]);
}
inline unsigned little_endian_16(std::string_view bytes, std::size_t at) {
  return byte_at(bytes, at) | byte_at(bytes, at + 1) << 8;
}
inline std::uint32_t little_endian_32(std::string_view bytes, std::size_t at) {
  return little_endian_16(bytes, at) | std::uint32_t{little_endian_16(bytes, at + 2)} << 16;
}

// Libraries quote names from a file with arbitrary bytes; escapes these.
inline std::string printable_reason(std::string reason) {
  for (char& c : reason)
    if (c < ' ' || c > '~') c = '?';
  return reason;
}

// Removes the fourth of four values of each pixel, in place.
template <typename T>
void drop_alpha(std::vector<T>& values) {
  const std::size_t pixels = values.size() / 4;
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < 3; ++c) values[3 * i + c] = values[4 * i + c];
  values.resize(3 * pixels);
}

}  // namespace tessera::core
