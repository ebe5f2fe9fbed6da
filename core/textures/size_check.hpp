// Whether a picture's file is long enough for the size that it claims, asked before memory is taken for its
// pixels. Stateless; thread-safe.
#pragma once

#include <string_view>

namespace tessera::core {

// `bytes` begin like a PNG or a JPEG; `width` and `height` are those of the header, both positive. No valid
// file is refused. A byte of PNG's compressed data stands for at most 1032 (RFC 1951: 258 bytes in two bits);
// of JPEG, a block of 64 pixels takes a bit at least (ITU-T T.81, annex F).
bool can_hold_png(std::string_view bytes, int width, int height);
bool can_hold_jpeg(std::string_view bytes, int width, int height);

}  // namespace tessera::core
