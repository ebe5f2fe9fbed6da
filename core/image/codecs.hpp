// SPDX-License-Identifier: Apache-2.0
// Reads image files of all formats that Tessera knows. The format is told by the file's content, not by its
// name. A broken or hostile file is an error, never a crash. The same bytes give the same pixels on every
// machine with the same libraries. Stateless; thread-safe.
#pragma once

#include <string_view>

#include "core/base/error.hpp"
#include "core/image/codec.hpp"

namespace tessera::core {

// What the header of an image file says, without decoding the pixels.
Result<ImageSize> image_size(std::string_view bytes);

// PNG, JPEG, Radiance HDR, OpenEXR, PFM, TIFF, WebP, BMP and TGA; docs/scene-format.md tells which variants.
// Decoding takes memory in proportion to the size in the header, whatever else is in the file. Errors
// complete a sentence that begins with the file's name, as in "is a GIF image, which is not supported; save
// it as PNG".
Result<DecodedImage> decode_pixels(std::string_view bytes, const DecodeOptions& options);

// Whether the file is of a format whose values are always linear radiance: HDR, OpenEXR or PFM.
bool is_linear_format(std::string_view bytes);

}  // namespace tessera::core
