// SPDX-License-Identifier: Apache-2.0
// The pixels of tiles as viewers receive them. Pure functions.
#pragma once

#include <cstddef>
#include <string>

#include "core/base/error.hpp"
#include "core/image/image.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::watch {

// 0 for an unknown format.
std::size_t bytes_per_pixel(v1::TileFormat format);

// The pixels in a known format (TileFormat of the protocol), as a zlib stream.
core::Result<std::string> encode_pixels(const core::Image& image, v1::TileFormat format);

}  // namespace tessera::watch
