// Radiance HDR files: whether one is, and whether it holds all the pixels it promises. Stateless;
// thread-safe.
#pragma once

#include <string_view>

namespace tessera::core {

// Whether the bytes begin like a Radiance HDR file, whose values are linear radiance.
bool is_hdr_picture(std::string_view bytes);

// stb_image 2.27 loops for ever on a file that was cut short within a run, and makes up pixels for others, so
// this is asked first. `width` and `height` are those of the header, both positive. Ward, "Real Pixels",
// Graphics Gems II (1991) tells the format.
bool is_complete_hdr(std::string_view bytes, int width, int height);

}  // namespace tessera::core
