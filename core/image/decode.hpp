// Files into linear pictures, for comparing them. Made for files of unknown origin: a broken or hostile one
// is an error, never a crash. Thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

// PNG or JPEG (taken for sRGB; alpha is ignored), Radiance HDR, PFM (colour or gray, either byte order; the
// scale's size is ignored) or OpenEXR (see exr.hpp), told apart by how the bytes begin.
Result<Image> decode_image(std::string_view bytes);

// The same from a file on this machine. Errors name the file.
Result<Image> read_image(const std::string& path);

}  // namespace tessera::core
