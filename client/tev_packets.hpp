// SPDX-License-Identifier: Apache-2.0
// The packets of tev's network protocol (https://github.com/Tom94/tev, "Over the Network"): the length of the
// whole packet, the operation, its parameters; integers are little-endian, texts end with a zero byte. Pure
// functions.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/film/region.hpp"

namespace tessera::client {

// An image in tev.
struct TevImage {
  std::string name{};
  int width = 0, height = 0;
  // "R", "Normal.X": tev shows those with the same beginning as a layer.
  std::vector<std::string> channels{};
};

// CreateImage (4): a black image. It replaces an image of the same name.
std::string tev_create_image(const TevImage& image);

// UpdateImage, version 3 (6): the pixels of a rectangle of the image. `values`: of each pixel, row by row,
// those of its channels side by side.
std::string tev_update_image(const TevImage& image, const core::PixelRect& rect,
                             std::span<const float> values);

}  // namespace tessera::client
