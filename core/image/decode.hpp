// SPDX-License-Identifier: Apache-2.0
// Reads image files as linear images, for comparing them. A broken or hostile file is an error, never a
// crash. Thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

// Any format of codecs.hpp. Codes of 8 and 16 bits are taken for sRGB, floats for linear. Alpha is ignored.
// Errors complete a sentence that begins with the file's name.
Result<Image> decode_image(std::string_view bytes);

// The same from a file on this machine. Errors begin with the file's name.
Result<Image> read_image(const std::string& path);

}  // namespace tessera::core
