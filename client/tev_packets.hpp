// SPDX-License-Identifier: Apache-2.0
// The packets of tev's network protocol (https://github.com/Tom94/tev, "Over the Network"): the length of the
// whole packet, the operation, its parameters; integers are little-endian, texts end with a zero byte. Pure
// functions.
#pragma once

#include <string>

#include "core/film/region.hpp"
#include "core/image/image.hpp"

namespace tessera::client {

// CreateImage (4): a black image with the channels R, G and B. It replaces an image of the same name.
std::string tev_create_image(const std::string& name, int width, int height);

// UpdateImage, version 3 (6): these pixels, whose top left has the coordinates (x, y) in the image.
std::string tev_update_image(const std::string& name, int x, int y, const core::Image& pixels);

}  // namespace tessera::client
