// SPDX-License-Identifier: Apache-2.0
// Escape sequences that draw an image at the cursor of a terminal. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "client/screen/screen_image.hpp"
#include "core/base/error.hpp"

namespace tessera::client {

enum class Graphics {
  kBlocks,  // half blocks: two pixels in each cell, in 24-bit colour
  kKitty,   // the graphics protocol of kitty, which WezTerm and Ghostty have too
  kSixel,
};

// "blocks", "kitty" or "sixel".
std::optional<Graphics> graphics_from_name(std::string_view name);

// INTERNAL: the library that encodes sixels failed.
core::Result<std::string> draw(const ScreenImage& image, Graphics graphics);

// draw() for each protocol. Lines of blocks end with "\r\n", except the last. Kitty replaces the image that
// the same process drew before.
std::string draw_blocks(const ScreenImage& image);
std::string draw_kitty(const ScreenImage& image);
core::Result<std::string> draw_sixel(const ScreenImage& image);

}  // namespace tessera::client
