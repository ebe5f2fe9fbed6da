// SPDX-License-Identifier: Apache-2.0
// Floors and skies that several scenes share. Stateless; the same bytes on every machine.
#pragma once

#include <string_view>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::backdrops {

// A chequerboard of 8 by 8 polished stone tiles, parted by thin joints.
core::Image terracotta_tiles();  // terracotta and ivory
core::Image slate_tiles();       // blue slate and ivory

// The whole sphere of directions (longitude to the right, latitude upwards) in linear light: a clear evening,
// the glow on the horizon in the middle of the image, dark earth below.
core::Image evening_sky();

// By the names of the functions above; the error lists them.
core::Result<core::Image> backdrop(std::string_view name);

}  // namespace tessera::backdrops
