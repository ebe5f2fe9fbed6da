// SPDX-License-Identifier: Apache-2.0
// Encodes images: PNG for screens, and three formats that keep linear light. The bytes depend on the image
// only (no dates, no names) and are the same on every machine. Thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

enum class ImageFormat {
  kPng,  // 8 bits, tone mapped (display.hpp), sRGB transfer function, clamped to [0, 1]
  kExr,  // OpenEXR, 32-bit floats, ZIP compression: loses nothing
  kHdr,  // Radiance RGBE: 8 bits of mantissa
  kPfm,  // portable float map, little-endian: loses nothing
};

// "png", "exr", "hdr" or "pfm", which are also the file extensions.
std::string_view image_format_name(ImageFormat format);

// Selects the format by file extension, case-insensitively. The error lists the known extensions.
Result<ImageFormat> image_format_from_path(std::string_view path);

// Checks that an image of this size fits the format. Call it before rendering.
Status check_encodable(ImageFormat format, int width, int height);

// The bytes of the file. `display` applies to PNG; the other formats store linear light. Fails only for
// sizes that check_encodable rejects, or if memory runs out.
Result<std::string> encode_image(const Image& image, ImageFormat format, const DisplaySettings& display = {});

}  // namespace tessera::core
