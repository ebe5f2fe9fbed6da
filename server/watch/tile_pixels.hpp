// SPDX-License-Identifier: Apache-2.0
// The pixels of tiles as viewers receive them. Pure functions.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "core/image/image.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::watch {

bool is_known(v1::TileFormat format);

// The pixels in a known format (TileFormat of the protocol), as a zlib stream.
core::Result<std::string> encode_pixels(const core::Image& image, v1::TileFormat format);

}  // namespace tessera::watch
