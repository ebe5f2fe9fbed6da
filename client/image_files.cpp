// SPDX-License-Identifier: Apache-2.0
#include "client/image_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "client/console.hpp"
#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"

namespace tessera::client {

using core::Status;

Status check_given_once(const std::string& path, std::span<const std::string> others) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) return {};
  const auto file_of = [&](const std::string& name) {
    return fs::weakly_canonical(fs::absolute(name, ignored), ignored);
  };
  for (const std::string& other : others)
    if (path == other || file_of(path) == file_of(other))
      return core::fail(core::ErrorCode::kInvalidArgument,
                        fmt::format("'{}' is given twice{}", path,
                                    path == other ? "" : fmt::format(", also as '{}'", other)));
  return {};
}

Status check_image_paths(const std::vector<std::string>& paths) {
  for (auto path = paths.begin(); path != paths.end(); ++path) {
    const core::Result<core::ImageFormat> format = core::image_format_from_path(*path);
    if (!format) return core::fail(format.error());
    if (Status once = check_given_once(*path, {paths.begin(), path}); !once) return once;
    if (Status status = core::check_can_write(*path); !status) return status;
  }
  return {};
}

Status check_image_size(const std::vector<std::string>& paths, const core::RenderSettings& settings) {
  const core::PixelRect window = settings.window();
  for (const std::string& path : paths) {
    const core::Result<core::ImageFormat> format = core::image_format_from_path(path);
    if (!format) return core::fail(format.error());
    const Status status = core::check_encodable(*format, window.width(), window.height());
    if (!status) return core::fail(status.error().within(path));
  }
  return {};
}

void warn_about_idle_display(const std::vector<std::string>& paths, const core::DisplayOverrides& overrides) {
  const auto is_png = [](const std::string& path) {
    const core::Result<core::ImageFormat> format = core::image_format_from_path(path);
    return format && *format == core::ImageFormat::kPng;
  };
  const bool given = overrides.exposure_stops || overrides.tone_curve;
  if (given && !paths.empty() && std::none_of(paths.begin(), paths.end(), is_png)) {
    print_warning("--exposure and --tone-curve change PNG files alone; linear files keep the light as it is");
  }
}

std::optional<core::ImagePosition> position_of(const core::RenderSettings& settings) {
  const core::PixelRect window = settings.window();
  if (window == core::PixelRect{0, 0, settings.width_px, settings.height_px}) return std::nullopt;
  return core::ImagePosition{window.x0, window.y0, settings.width_px, settings.height_px};
}

namespace {

// Writes what encode(format) returns for each path.
template <typename Encode>
Status write_each(const std::vector<std::string>& paths, const Encode& encode) {
  for (const std::string& path : paths) {
    const core::Result<core::ImageFormat> format = core::image_format_from_path(path);
    if (!format) return core::fail(format.error());
    const core::Result<std::string> bytes = encode(*format);
    if (!bytes) return core::fail(bytes.error().within(path));
    if (Status status = core::write_file_atomically(path, *bytes); !status) return status;
  }
  return {};
}

}  // namespace

Status write_image_files(const std::vector<std::string>& paths, const core::Image& image,
                         const core::RenderSettings& settings, const core::DisplaySettings& display,
                         const core::TextAttributes& attributes) {
  const auto position = position_of(settings);
  return write_each(paths, [&](core::ImageFormat format) {
    return core::encode_image(image, format, display, position, attributes);
  });
}

Status write_layers(const std::vector<std::string>& paths, const LayerImage& image,
                    const core::DisplaySettings& display) {
  const core::TileGrid grid(image.settings.window(), core::kTilePx);
  core::LayerRows rows(grid, grid.window(), image.settings.layers, image.tile);
  const core::ChannelRows source{grid.width(),
                                 grid.height(),
                                 core::image_channels(image.settings.layers),
                                 [&rows](int y) { return rows.row(y); },
                                 position_of(image.settings),
                                 image.attributes};
  return write_each(paths,
                    [&](core::ImageFormat format) { return core::encode_channels(source, format, display); });
}

void warn_about_idle_layers(const std::vector<std::string>& paths, core::LayerSet layers) {
  const auto has = [&](core::ImageFormat wanted) {
    return std::any_of(paths.begin(), paths.end(), [&](const std::string& path) {
      const auto format = core::image_format_from_path(path);
      return format && *format == wanted;
    });
  };
  if (paths.empty() || has(core::ImageFormat::kExr)) return;
  const bool alpha_only = layers == core::LayerSet{}.with(core::Layer::kAlpha);
  if (layers.empty() || alpha_only) return;
  print_warning("layers are written to .exr files only, and alpha to .png: add -o FILE.exr");
}

}  // namespace tessera::client
