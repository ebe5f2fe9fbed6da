#include "core/textures/size_check.hpp"

#include <cstddef>
#include <cstdint>

namespace tessera::core {
namespace {

// The first chunk, if it is the one that tells the size: where its parts are.
constexpr std::size_t kFirstChunkName = 12, kBitDepth = 24, kColorType = 25;

std::uint64_t product(int width, int height) {
  return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
}

std::uint64_t channels(unsigned char color_type) {
  switch (color_type) {
    case 2:
      return 3;
    case 4:
      return 2;
    case 6:
      return 4;
    default:
      return 1;
  }
}

// At least one, also where the file begins with something else.
std::uint64_t png_bits_per_pixel(std::string_view bytes) {
  if (bytes.size() <= kColorType || bytes.substr(kFirstChunkName, 4) != "IHDR") return 1;
  const auto depth = static_cast<unsigned char>(bytes[kBitDepth]);
  const bool is_depth = depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16;
  return is_depth ? depth * channels(static_cast<unsigned char>(bytes[kColorType])) : 1;
}

}  // namespace

bool can_hold_png(std::string_view bytes, int width, int height) {
  constexpr std::uint64_t kMostBytesOfOne = 1032;
  return product(width, height) * png_bits_per_pixel(bytes) <= 8 * kMostBytesOfOne * bytes.size();
}

bool can_hold_jpeg(std::string_view bytes, int width, int height) {
  constexpr std::uint64_t kMostPixelsOfABit = 64;
  return product(width, height) <= 8 * kMostPixelsOfABit * bytes.size();
}

}  // namespace tessera::core
