// SPDX-License-Identifier: Apache-2.0
// The image files a command is asked to write (-o): checked before the work, written after it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/develop.hpp"
#include "core/image/display.hpp"
#include "core/image/encode.hpp"
#include "core/image/image.hpp"
#include "core/scene/render_record.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

// Whether the path is that of none of the others, however they are written. Devices and pipes may be.
core::Status check_given_once(const std::string& path, std::span<const std::string> others);
// Whether every name has an ending we know, none is given twice, and each could be written now.
core::Status check_image_paths(const std::vector<std::string>& paths);

// Whether the image that the settings ask for fits the formats.
core::Status check_image_size(const std::vector<std::string>& paths, const core::RenderSettings& settings);

// Warns that the options for PNG files change nothing where there are some, but no such file.
void warn_about_idle_display(const std::vector<std::string>& paths, const core::DisplayOverrides& overrides);

// Where the window of the settings lies in the image; nothing if it is all of it.
std::optional<core::ImagePosition> position_of(const core::RenderSettings& settings);

// Writes the image, the window of the settings, to each path, in order, PNG files as `display` says and
// `attributes` into the header of .exr files; stops at the first failure, which names the path.
core::Status write_image_files(const std::vector<std::string>& paths, const core::Image& image,
                               const core::RenderSettings& settings, const core::DisplaySettings& display,
                               const core::TextAttributes& attributes = {});

// An image with layers, from the sums of a film.
struct LayerImage {
  core::RenderSettings settings;
  core::LayerRows::TileSource tile;   // of the grid over the window of the settings
  core::TextAttributes attributes{};  // of the header of .exr files
};

// The same for an image with layers, tile row by tile row.
core::Status write_layers(const std::vector<std::string>& paths, const LayerImage& image,
                          const core::DisplaySettings& display);

// Warns if layers were chosen that none of the files can hold.
void warn_about_idle_layers(const std::vector<std::string>& paths, core::LayerSet layers);

}  // namespace tessera::client
