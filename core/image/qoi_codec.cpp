// SPDX-License-Identifier: Apache-2.0
// QOI by the reference decoder of Szablewski.
#define QOI_IMPLEMENTATION
#define QOI_NO_STDIO
#include <qoi.h>

#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "core/image/codec.hpp"

namespace tessera::core {
namespace qoi {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kHeaderBytes = 14;
constexpr std::string_view kEnd = "\0\0\0\0\0\0\0\1"sv;

struct Free {
  void operator()(void* memory) const { std::free(memory); }
};

std::uint32_t big_endian_32(std::string_view bytes, std::size_t at) {
  return byte_at(bytes, at) << 24 | byte_at(bytes, at + 1) << 16 | byte_at(bytes, at + 2) << 8 |
         byte_at(bytes, at + 3);
}

bool matches(std::string_view bytes) {
  return bytes.starts_with("qoif");
}

Result<ImageSize> read_size(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes) return broken_image("QOI", kEndsTooEarly);
  constexpr std::uint32_t kMostPerByte = 62;  // the longest run
  const std::uint64_t width = big_endian_32(bytes, 4), height = big_endian_32(bytes, 8);
  constexpr std::uint64_t kMaxSide = std::numeric_limits<int>::max();
  if (width > kMaxSide || height > kMaxSide || width * height > kMostPerByte * bytes.size())
    return broken_image(
        "QOI", implausible_size(static_cast<std::int64_t>(width), static_cast<std::int64_t>(height)));
  return ImageSize{static_cast<int>(width), static_cast<int>(height)};
}

// The decoder does not tell whether pixels are missing, but every file has a mark at its end.
Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions& options) {
  if (bytes.size() < kHeaderBytes + kEnd.size() || !bytes.ends_with(kEnd))
    return broken_image("QOI", kEndsTooEarly);
  const unsigned stored_channels = byte_at(bytes, 12);
  if (stored_channels < 3 || stored_channels > 4 || byte_at(bytes, 13) > 1)
    return broken_image("QOI", "its channels or its colour space are unknown");
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      static_cast<unsigned>(size.height) >= QOI_PIXELS_MAX / static_cast<unsigned>(size.width))
    return unsupported_image("a QOI image of more than 400 million pixels", "save it as PNG");
  const std::size_t channels = options.keep_alpha && stored_channels == 4 ? 4 : 3;
  qoi_desc described{};
  const std::unique_ptr<void, Free> pixels(
      qoi_decode(bytes.data(), static_cast<int>(bytes.size()), &described, static_cast<int>(channels)));
  if (!pixels) throw std::bad_alloc();
  std::vector<std::string> warnings;
  if (byte_at(bytes, 13) == 1)
    warnings.emplace_back("says that its values are linear, which is not used: they count as sRGB or linear");
  const auto* first = static_cast<const std::uint8_t*>(pixels.get());
  return DecodedImage{.size = size,
                      .channels = channels,
                      .values = DecodedImage::Bytes(first, first + channels * size.pixels()),
                      .warnings = std::move(warnings)};
}

}  // namespace
}  // namespace qoi

const Codec kQoiCodec{"QOI", false, qoi::matches, qoi::read_size, qoi::decode};

}  // namespace tessera::core
