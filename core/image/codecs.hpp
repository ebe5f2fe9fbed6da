// SPDX-License-Identifier: Apache-2.0
// Reads image files of all supported formats. The format is detected by content, not by the file's name. A
// broken or hostile file is an error, never a crash. The same bytes give the same pixels on every machine
// with the same library versions. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/image/codec.hpp"

namespace tessera::core {

// The image size from the header of an image file, without decoding pixels.
Result<ImageSize> image_size(std::string_view bytes);

// The layers of an OpenEXR file, as DecodeOptions::layer takes them: "" is the image itself. Channels that
// are in no layer of up to three channels stand by their own names, so that all layers together have every
// channel of the file. Other formats have the image alone.
Result<std::vector<std::string>> image_layers(std::string_view bytes);

// Decodes PNG, JPEG, Radiance HDR, OpenEXR, PFM, TIFF, WebP, BMP, QOI and TGA; docs/scene-format.md lists the
// supported variants. Memory use is proportional to the size in the header, whatever else is in the file.
// Error messages complete a sentence that begins with the file's name, as in "is a GIF image, which is not
// supported; save it as PNG".
Result<DecodedImage> decode_pixels(std::string_view bytes, const DecodeOptions& options);

// Whether the file is of a format whose values are always linear radiance: HDR, OpenEXR or PFM.
bool is_linear_format(std::string_view bytes);

}  // namespace tessera::core
