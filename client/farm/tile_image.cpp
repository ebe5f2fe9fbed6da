// SPDX-License-Identifier: Apache-2.0
#include "client/farm/tile_image.hpp"

#include <half.h>
#include <libdeflate.h>

#include <bit>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "proto/convert.hpp"

namespace tessera::client {
namespace {

static_assert(std::endian::native == std::endian::little);

struct FreeDecompressor {
  void operator()(libdeflate_decompressor* decompressor) const {
    ::libdeflate_free_decompressor(decompressor);
  }
};

tl::unexpected<core::Error> damaged(const char* what) {
  return core::fail(core::ErrorCode::kDataLoss, std::string("a tile of the coordinator ") + what);
}

// `count` numbers of a zlib stream; none if it does not hold just as many.
std::vector<std::uint16_t> inflate(const std::string& bytes, std::size_t count) {
  const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor(
      ::libdeflate_alloc_decompressor());
  std::vector<std::uint16_t> numbers(count);
  const bool whole =
      decompressor && ::libdeflate_zlib_decompress(decompressor.get(), bytes.data(), bytes.size(),
                                                   numbers.data(), 2 * count, nullptr) == LIBDEFLATE_SUCCESS;
  return whole ? numbers : std::vector<std::uint16_t>();
}

float float_of(std::uint16_t bits) {
  return static_cast<float>(Imath::half(Imath::half::FromBits, bits));
}

}  // namespace

core::Status paint_tile(const v1::TileImage& tile, const core::PixelRect& window, core::Image& image) {
  const auto rect = proto::from_proto(tile.rect());
  if (!rect || !window.contains(*rect)) return damaged("is outside the image");
  const auto numbers = inflate(tile.pixels_zlib(), 3 * rect->pixel_count());
  if (numbers.empty()) return damaged("has damaged pixels");
  const std::uint16_t* next = numbers.data();
  for (int y = rect->y0; y < rect->y1; ++y)
    for (int x = rect->x0; x < rect->x1; ++x, next += 3)
      image.at(x - window.x0, y - window.y0) = {float_of(next[0]), float_of(next[1]), float_of(next[2])};
  return {};
}

}  // namespace tessera::client
