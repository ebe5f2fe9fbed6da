// SPDX-License-Identifier: Apache-2.0
// The picture files a command is asked to write (-o): checked before the work, written after it.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "core/image/image.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

// Whether every name has an ending we know, none is given twice, and each could be written now.
core::Status check_picture_paths(const std::vector<std::string>& paths);

// Whether the picture that the settings ask for fits the formats.
core::Status check_picture_size(const std::vector<std::string>& paths, const core::RenderSettings& settings);

// Warns that the options for PNG files change nothing where there are some, but no such file.
void warn_about_idle_display(const std::vector<std::string>& paths, const core::DisplayOverrides& overrides);

// Writes the picture to each path, in order, PNG files as `display` says; stops at the first failure, which
// names the path.
core::Status write_pictures(const std::vector<std::string>& paths, const core::Image& image,
                            const core::DisplaySettings& display);

}  // namespace tessera::client
