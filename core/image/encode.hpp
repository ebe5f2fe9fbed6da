// SPDX-License-Identifier: Apache-2.0
// Pictures into files: PNG for screens, and three formats that keep linear light.
// The bytes are a function of the picture alone: no dates, no names, the same from any machine. Thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

enum class ImageFormat {
  kPng,  // 8 bits, exposed and curved (see display.hpp), sRGB transfer function, clamped to [0, 1]
  kExr,  // OpenEXR, 32-bit floats, ZIP compression: loses nothing
  kHdr,  // Radiance RGBE: 8 bits of mantissa
  kPfm,  // portable float map, little-endian: loses nothing
};

// "png", "exr", "hdr" or "pfm": also the ending of file names.
std::string_view image_format_name(ImageFormat format);

// By the ending of the file's name, in upper or lower case. The error lists the endings that are known.
Result<ImageFormat> image_format_from_path(std::string_view path);

// Whether a picture of this size fits the format; to be asked before rendering it.
Status check_encodable(ImageFormat format, int width, int height);

// The bytes of the file. `display` says how a PNG shows the light; the other formats keep it. Fails only for
// a picture that check_encodable refuses, or for want of memory.
Result<std::string> encode_image(const Image& image, ImageFormat format, const DisplaySettings& display = {});

}  // namespace tessera::core
