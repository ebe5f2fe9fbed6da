// SPDX-License-Identifier: Apache-2.0
// An image as a terminal shows it: scaled down to fit, with 8 bits per channel. A pure function.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/display.hpp"
#include "core/image/image.hpp"

namespace tessera::client {

struct ScreenImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // width * height * 3, row-major, sRGB

  // The three channels of a pixel.
  const std::uint8_t* at(int x, int y) const {
    return rgb.data() +
           3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

// Scales an image that is not empty down, by the mean of the light on each pixel, so that it fits into this
// size with its aspect ratio. It is never enlarged. Then applies exposure, tone curve and the sRGB transfer
// function.
ScreenImage fit_to_screen(const core::Image& image, int max_width, int max_height,
                          const core::DisplaySettings& display);

}  // namespace tessera::client
