// SPDX-License-Identifier: Apache-2.0
// An image in memory: linear RGB floats, row-major from the top left, no padding.
#pragma once

#include <cstddef>
#include <vector>

#include "core/math/rgb.hpp"

namespace tessera::core {

struct Image {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;  // width * height

  Image() = default;
  Image(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  Rgb& at(int x, int y) { return pixels[index(x, y)]; }
  const Rgb& at(int x, int y) const { return pixels[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

// The pixels [x, x + width) x [y, y + height) of an image.
struct ImageRegion {
  int x = 0, y = 0, width = 0, height = 0;
};

}  // namespace tessera::core
