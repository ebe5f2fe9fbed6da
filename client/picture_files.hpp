// The picture files a command is asked to write (-o): checked before the work, written after it.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::client {

// Whether every name has an ending we know, none is given twice, and each could be written now.
core::Status check_picture_paths(const std::vector<std::string>& paths);

// Whether a picture of this size fits the formats.
core::Status check_picture_size(const std::vector<std::string>& paths, int width_px, int height_px);

// Writes the picture to each path, in order; stops at the first failure, which names the path.
core::Status write_pictures(const std::vector<std::string>& paths, const core::Image& image);

}  // namespace tessera::client
