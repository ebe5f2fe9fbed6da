// SPDX-License-Identifier: Apache-2.0
// BMP by stb_image, uncompressed only.
#include <stb_image.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>

#include "core/image/codec.hpp"
#include "core/image/stb_memory.hpp"

namespace tessera::core {
namespace bmp {
namespace {

struct StbFree {
  void operator()(void* values) const { stbi_image_free(values); }
};

// Sizes of the file header (14 bytes) and of the start of the image header.
constexpr std::size_t kPixelOffset = 10, kHeaderSize = 14, kHeaderBytes = 34;
constexpr std::uint32_t kOs2HeaderSize = 12;

bool matches(std::string_view bytes) {
  return bytes.size() >= 18 && bytes.starts_with("BM") &&
         little_endian_32(bytes, kHeaderSize) >= kOs2HeaderSize &&
         little_endian_32(bytes, kHeaderSize) <= 124;
}

Result<ImageSize> read_size(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes) return broken_image("BMP", kEndsTooEarly);
  if (little_endian_32(bytes, kHeaderSize) == kOs2HeaderSize)
    return ImageSize{static_cast<int>(little_endian_16(bytes, 18)),
                     static_cast<int>(little_endian_16(bytes, 20))};
  const auto width = static_cast<std::int32_t>(little_endian_32(bytes, 18));
  const auto height = static_cast<std::int32_t>(little_endian_32(bytes, 22));  // negative: from the top down
  if (height == std::numeric_limits<std::int32_t>::min()) return broken_image("BMP", "it has no pixels");
  return ImageSize{width, std::abs(height)};
}

// 0 is uncompressed; 3 and 6 are uncompressed with channel masks.
Status check_compression(std::string_view bytes) {
  if (little_endian_32(bytes, kHeaderSize) == kOs2HeaderSize) return {};
  const std::uint32_t compression = little_endian_32(bytes, 30);
  if (compression == 0 || compression == 3 || compression == 6) return {};
  return unsupported_image("a compressed BMP image", "save it uncompressed or as PNG");
}

bool has_all_rows(std::string_view bytes, ImageSize size) {
  const bool is_os2 = little_endian_32(bytes, kHeaderSize) == kOs2HeaderSize;
  const std::uint64_t bits = little_endian_16(bytes, is_os2 ? 24 : 28);
  const std::uint64_t row_bytes = (static_cast<std::uint64_t>(size.width) * bits + 31) / 32 * 4;
  const std::uint64_t offset = little_endian_32(bytes, kPixelOffset);
  // The padding after the last row may be missing.
  return bytes.size() + 3 >= offset + row_bytes * static_cast<std::uint64_t>(size.height);
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions& options) {
  if (const Status status = check_compression(bytes); !status) return fail(status.error());
  if (!has_all_rows(bytes, size)) return broken_image("BMP", kEndsTooEarly);
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return fail(ErrorCode::kInvalidArgument, "is a BMP image of more than 2 GB; save it as PNG");
  int width = 0, height = 0, stored_channels = 0;
  const StbMemory memory(size.width, size.height, bytes.size());
  const std::unique_ptr<stbi_uc[], StbFree> rgba(
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()),
                            &width, &height, &stored_channels, 4));
  if (memory.ran_out()) throw std::bad_alloc();
  if (!rgba) return broken_image("BMP", printable_reason(stbi_failure_reason()));
  if (width != size.width || height != size.height) return broken_image("BMP", "it has two sizes");
  DecodedImage::Bytes values(rgba.get(), rgba.get() + 4 * size.pixels());
  const bool keep_alpha = options.keep_alpha && stored_channels == 4;
  if (!keep_alpha) drop_alpha(values);
  return DecodedImage{
      .size = size, .channels = keep_alpha ? 4u : 3u, .values = std::move(values), .warnings = {}};
}

}  // namespace
}  // namespace bmp

const Codec kBmpCodec{"BMP", false, bmp::matches, bmp::read_size, bmp::decode};

}  // namespace tessera::core
