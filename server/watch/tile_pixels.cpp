// SPDX-License-Identifier: Apache-2.0
#include "server/watch/tile_pixels.hpp"

#include <half.h>
#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

namespace tessera::watch {

namespace {

static_assert(std::endian::native == std::endian::little);

// The fastest level: of a noisy image, higher ones save a few percent.
constexpr int kLevel = 1;

std::vector<std::uint16_t> halves_of(const core::Image& image) {
  std::vector<std::uint16_t> halves;
  halves.reserve(3 * image.pixels.size());
  constexpr float kLargest = 65504;
  const auto add = [&](float value) {
    halves.push_back(Imath::half(std::clamp(value, -kLargest, kLargest)).bits());
  };
  for (const auto& pixel : image.pixels) {
    add(pixel.r);
    add(pixel.g);
    add(pixel.b);
  }
  return halves;
}

std::vector<float> floats_of(const core::Image& image) {
  std::vector<float> floats;
  floats.reserve(3 * image.pixels.size());
  for (const auto& pixel : image.pixels) floats.insert(floats.end(), {pixel.r, pixel.g, pixel.b});
  return floats;
}

struct FreeCompressor {
  void operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }
};

core::Result<std::string> compress(const void* bytes, std::size_t size) {
  const std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor(
      libdeflate_alloc_compressor(kLevel));
  if (!compressor)
    return core::fail(core::ErrorCode::kResourceExhausted, "out of memory for the compression of a tile");
  std::string compressed(libdeflate_zlib_compress_bound(compressor.get(), size), '\0');
  compressed.resize(
      libdeflate_zlib_compress(compressor.get(), bytes, size, compressed.data(), compressed.size()));
  return compressed;
}

template <typename Number>
core::Result<std::string> compress(const std::vector<Number>& numbers) {
  return compress(numbers.data(), numbers.size() * sizeof(Number));
}

}  // namespace

bool is_known(v1::TileFormat format) {
  return format == v1::TILE_FORMAT_RGB16F || format == v1::TILE_FORMAT_RGB32F;
}

core::Result<std::string> encode_pixels(const core::Image& image, v1::TileFormat format) {
  return format == v1::TILE_FORMAT_RGB16F ? compress(halves_of(image)) : compress(floats_of(image));
}

}  // namespace tessera::watch
