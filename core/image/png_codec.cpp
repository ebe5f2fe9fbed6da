// SPDX-License-Identifier: Apache-2.0
// PNG by libspng. Checksums are not verified: a file with readable pixels is accepted.
#include <spng.h>

#include <array>
#include <memory>
#include <new>

#include "core/image/codec.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {
namespace png {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";

struct SpngFree {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using SpngContext = std::unique_ptr<spng_ctx, SpngFree>;

// The maximum decompressed size of a non-pixel chunk beyond the file size.
constexpr std::size_t kChunkBytes = std::size_t{1} << 24;

SpngContext open_png(std::string_view bytes) {
  SpngContext context(spng_ctx_new(SPNG_CTX_IGNORE_ADLER32));
  if (!context) throw std::bad_alloc();
  spng_set_crc_action(context.get(), SPNG_CRC_USE, SPNG_CRC_USE);
  spng_set_chunk_limits(context.get(), bytes.size() + kChunkBytes, bytes.size() + kChunkBytes);
  spng_set_png_buffer(context.get(), bytes.data(), bytes.size());
  return context;
}

tl::unexpected<Error> spng_failure(int code) {
  if (code == SPNG_EMEM) throw std::bad_alloc();
  return broken_image("PNG", code == SPNG_IO_EOF ? kEndsTooEarly : std::string_view(spng_strerror(code)));
}

bool matches(std::string_view bytes) {
  return bytes.starts_with(kSignature);
}

Result<ImageSize> read_size(std::string_view bytes) {
  const SpngContext context = open_png(bytes);
  spng_ihdr header{};
  if (const int code = spng_get_ihdr(context.get(), &header); code != 0) return spng_failure(code);
  return ImageSize{static_cast<int>(header.width), static_cast<int>(header.height)};
}

// Whether the file is long enough for its pixels: a byte of deflated data encodes at most 1032 bytes (RFC
// 1951: 258 bytes in two bits).
bool is_long_enough(const spng_ihdr& header, std::size_t file_bytes) {
  constexpr std::uint64_t kMaxBytesOfOne = 1032;
  constexpr std::array<std::uint64_t, 7> kChannels{1, 1, 3, 1, 2, 1, 4};  // by colour type
  const std::uint64_t bits = header.bit_depth * kChannels[header.color_type];
  return std::uint64_t{header.width} * header.height * bits <= 8 * kMaxBytesOfOne * file_bytes;
}

template <typename T>
Result<DecodedImage> decode_as(spng_ctx* context, ImageSize size, int format, std::size_t stored_channels,
                               bool keep_alpha) {
  std::vector<T> values(size.pixels() * stored_channels);
  const int flags = keep_alpha ? SPNG_DECODE_TRNS : 0;
  if (const int code = spng_decode_image(context, values.data(), values.size() * sizeof(T), format, flags);
      code != 0)
    return spng_failure(code);
  const std::size_t channels = keep_alpha ? 4 : 3;
  if (stored_channels > channels) drop_alpha(values);
  return DecodedImage{.size = size, .channels = channels, .values = std::move(values), .warnings = {}};
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions& options) {
  const SpngContext context = open_png(bytes);
  spng_ihdr header{};
  if (const int code = spng_get_ihdr(context.get(), &header); code != 0) return spng_failure(code);
  if (!is_long_enough(header, bytes.size())) return broken_image("PNG", kEndsTooEarly);
  spng_trns transparency{};
  const int lacks_trns = spng_get_trns(context.get(), &transparency);
  if (lacks_trns != 0 && lacks_trns != SPNG_ECHUNKAVAIL) return spng_failure(lacks_trns);
  const bool has_alpha = lacks_trns == 0 || header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA ||
                         header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
  const bool keep_alpha = has_alpha && options.keep_alpha;
  if (header.bit_depth == 16)
    return decode_as<std::uint16_t>(context.get(), size, SPNG_FMT_RGBA16, 4, keep_alpha);
  return keep_alpha ? decode_as<std::uint8_t>(context.get(), size, SPNG_FMT_RGBA8, 4, true)
                    : decode_as<std::uint8_t>(context.get(), size, SPNG_FMT_RGB8, 3, false);
}

}  // namespace
}  // namespace png

const Codec kPngCodec{"PNG", false, png::matches, png::read_size, png::decode};

}  // namespace tessera::core
