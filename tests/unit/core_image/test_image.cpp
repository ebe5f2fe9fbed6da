// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_image/test_image.hpp"

#include <bit>
#include <cmath>
#include <random>

namespace tessera::core {

Image random_image(int width, int height, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto value = [&random] {
    const int mantissa = static_cast<int>(random() % (1 << 24));
    const int exponent = static_cast<int>(random() % 40) - 28;
    return std::ldexp(static_cast<float>(mantissa), exponent - 24);
  };
  Image image(width, height);
  for (Rgb& pixel : image.pixels) {
    pixel.r = value();
    pixel.g = value();
    pixel.b = value();
  }
  return image;
}

std::vector<std::uint32_t> bits_of(const Image& image) {
  std::vector<std::uint32_t> bits;
  for (const Rgb& pixel : image.pixels) {
    for (int channel = 0; channel < 3; ++channel)
      bits.push_back(std::bit_cast<std::uint32_t>(pixel[channel]));
  }
  return bits;
}

}  // namespace tessera::core
