// Files into linear pictures, for comparing them. Made for files of unknown origin: a broken or hostile one
// is an error, never a crash. Thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

// PNG (8 or 16 bits, taken for sRGB), Radiance HDR, PFM (colour or gray, either byte order; the size of its
// scale is ignored) or OpenEXR (see exr.hpp), told apart by how the bytes begin. Alpha is ignored.
Result<Image> decode_image(std::string_view bytes);

// The same from a file on this machine. Errors name the file.
Result<Image> read_image(const std::string& path);

}  // namespace tessera::core
