// Finds what stb_image 2.27 does not notice about JPEG files. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string_view>

namespace tessera::core {

// What is wrong with a file that begins like a JPEG: it has no end marker (stb_image fills what is missing
// with gray), or a Huffman table with more than 256 symbols (it writes past the end of its own). nullopt
// where both are well; nothing else is checked. ITU-T T.81, annex B tells the format.
std::optional<std::string_view> jpeg_fault(std::string_view bytes);

}  // namespace tessera::core
