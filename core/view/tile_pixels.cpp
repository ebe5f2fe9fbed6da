// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_pixels.hpp"

#include <half.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "core/film/develop.hpp"
#include "core/film/fixed_point.hpp"

namespace tessera::view {
namespace {

static_assert(std::endian::native == std::endian::little);

// The fastest level: of a noisy image, higher ones save a few percent.
constexpr int kCompression = 1;

// The exact sum of up to 2^32 sums.
class WideSum {
 public:
  void add(std::uint64_t sum) {
    low_ += sum & 0xffffffff;
    high_ += sum >> 32;
  }
  // Rounded once, as long as there is one term.
  double value() const { return static_cast<double>(high_) * 0x1p32 + static_cast<double>(low_); }

 private:
  std::uint64_t low_ = 0, high_ = 0;
};

// The mean over the pixels [x0, x1) x [y0, y1) of a tile.
core::Rgb block_mean(const core::Film::TileSums& sums, int row_px, const core::PixelRect& block) {
  std::array<WideSum, 3> total;
  for (int y = block.y0; y < block.y1; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(row_px);
    for (int x = block.x0; x < block.x1; ++x) {
      const std::size_t pixel = 3 * (row + static_cast<std::size_t>(x));
      for (std::size_t channel = 0; channel < 3; ++channel) total[channel].add(sums.sums[pixel + channel]);
    }
  }
  const double count = static_cast<double>(sums.samples) * static_cast<double>(block.pixel_count());
  const auto mean = [&](const WideSum& sum) {
    return static_cast<float>(sum.value() * core::kFilmUnit / count);
  };
  return {mean(total[0]), mean(total[1]), mean(total[2])};
}

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
      libdeflate_alloc_compressor(kCompression));
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

struct FreeDecompressor {
  void operator()(libdeflate_decompressor* decompressor) const { libdeflate_free_decompressor(decompressor); }
};

std::string bytes_of(const std::vector<std::uint16_t>& numbers) {
  std::string bytes(numbers.size() * sizeof numbers[0], '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

// `count` numbers of a zlib stream that holds just as many; otherwise none.
template <typename Number>
std::vector<Number> decompress(const std::string& bytes, std::size_t count) {
  const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor(
      libdeflate_alloc_decompressor());
  std::vector<Number> numbers(count);
  const bool is_whole = decompressor && libdeflate_zlib_decompress(
                                            decompressor.get(), bytes.data(), bytes.size(), numbers.data(),
                                            count * sizeof(Number), nullptr) == LIBDEFLATE_SUCCESS;
  return is_whole ? numbers : std::vector<Number>();
}

std::vector<std::uint16_t> raw_numbers(const std::string& bytes, std::size_t count) {
  std::vector<std::uint16_t> numbers(bytes.size() == count * sizeof(std::uint16_t) ? count : 0);
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(std::uint16_t));
  return numbers;
}

float float_of(std::uint16_t half) {
  return static_cast<float>(Imath::half(Imath::half::FromBits, half));
}

float float_of(float value) {
  return value;
}

tl::unexpected<core::Error> damaged() {
  return core::fail(core::ErrorCode::kDataLoss, "the pixels of a tile are damaged");
}

template <typename Number>
core::Result<core::Image> image_of(const std::vector<Number>& numbers, core::Image image) {
  if (numbers.empty()) return damaged();
  const Number* next = numbers.data();
  for (core::Rgb& pixel : image.pixels) {
    pixel = {float_of(next[0]), float_of(next[1]), float_of(next[2])};
    next += 3;
  }
  return image;
}

}  // namespace

core::Image develop_level(const core::PixelRect& rect, const core::Film::TileSums& sums, int level) {
  core::Image image(level_size(rect.width(), level), level_size(rect.height(), level));
  if (sums.samples == 0) return image;
  const int side = 1 << level;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const core::PixelRect block{x * side, y * side, std::min((x + 1) * side, rect.width()),
                                  std::min((y + 1) * side, rect.height())};
      image.at(x, y) = block_mean(sums, rect.width(), block);
    }
  }
  return image;
}

core::Result<std::string> encode_pixels(const core::Image& image, PixelFormat format) {
  switch (format) {
    case PixelFormat::kHalf:
      return compress(halves_of(image));
    case PixelFormat::kFloat:
      return compress(floats_of(image));
    case PixelFormat::kRawHalf:
      break;
  }
  return bytes_of(halves_of(image));
}

core::Result<core::Image> decode_pixels(const std::string& pixels, int width, int height,
                                        PixelFormat format) {
  core::Image image(width, height);
  const std::size_t count = 3 * image.pixels.size();
  switch (format) {
    case PixelFormat::kHalf:
      return image_of(decompress<std::uint16_t>(pixels, count), std::move(image));
    case PixelFormat::kFloat:
      return image_of(decompress<float>(pixels, count), std::move(image));
    case PixelFormat::kRawHalf:
      break;
  }
  return image_of(raw_numbers(pixels, count), std::move(image));
}

core::Result<std::string> encode_channels(core::LayerSet layers, const core::PixelRect& rect,
                                          const core::Film::TileSums& sums) {
  std::vector<float> values(rect.pixel_count() * core::image_channels(layers).size());
  if (sums.samples > 0) core::develop_layers(layers, rect, sums, values);
  return compress(values);
}

core::Result<std::vector<float>> decode_channels(const std::string& pixels, std::size_t count) {
  auto values = decompress<float>(pixels, count);
  if (values.empty()) return damaged();
  return values;
}

}  // namespace tessera::view
