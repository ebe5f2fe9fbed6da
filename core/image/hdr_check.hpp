// Whether a Radiance HDR file holds all the pixels it promises. stb_image 2.27 loops for ever on one that was
// cut short within a run, and makes up pixels for others, so this is asked first. Stateless; thread-safe.
#pragma once

#include <string_view>

namespace tessera::core {

// `width` and `height` are those of the header, both positive. Ward, "Real Pixels", Graphics Gems II (1991)
// tells the format.
bool is_complete_hdr(std::string_view bytes, int width, int height);

}  // namespace tessera::core
