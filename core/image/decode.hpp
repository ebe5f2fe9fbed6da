// SPDX-License-Identifier: Apache-2.0
// Reads image files as linear images, for comparison. A broken or hostile file is an error, never a crash.
// Thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

// Decodes any format of codecs.hpp. Codes of 8 and 16 bits are interpreted as sRGB, floats as linear. Alpha
// is ignored. Error messages complete a sentence that begins with the file's name.
Result<Image> decode_image(std::string_view bytes, const std::string& layer = {});

// Reads and decodes a local file, or a layer of it (DecodeOptions::layer). Error messages begin with the
// file's name.
Result<Image> read_image(const std::string& path, const std::string& layer = {});

}  // namespace tessera::core
