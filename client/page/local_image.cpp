// SPDX-License-Identifier: Apache-2.0
#include "client/page/local_image.hpp"

#include <fmt/format.h>

#include <charconv>
#include <string>
#include <string_view>
#include <utility>

#include "core/image/encode.hpp"
#include "core/view/shown_layer.hpp"
#include "core/view/stream_query.hpp"
#include "core/view/tile_rows.hpp"

namespace tessera::client {
namespace {

tl::unexpected<core::Error> invalid(const char* parameter, const std::string& message) {
  return core::fail(
      core::Error{core::ErrorCode::kInvalidArgument, fmt::format("{}: {}", parameter, message)}.with(
          core::ErrorDetails{.field = parameter}));
}

class StringSink final : public core::ByteSink {
 public:
  core::Status write_at(std::uint64_t offset, std::string_view bytes) override {
    const auto at = static_cast<std::size_t>(offset);
    if (bytes_.size() < at + bytes.size()) bytes_.resize(at + bytes.size());
    bytes_.replace(at, bytes.size(), bytes);
    return {};
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

core::Result<core::DisplaySettings> display_of(const LocalJob& job, const http::Request& request) {
  core::DisplayOverrides overrides;
  if (const auto text = request.parameter("exposure")) {
    float stops = 0;
    const auto [end, wrong] = std::from_chars(text->data(), text->data() + text->size(), stops);
    if (wrong != std::errc() || end != text->data() + text->size())
      return invalid("exposure", "must be a number of stops");
    overrides.exposure_stops = stops;
  }
  if (const auto name = request.parameter("tone_curve")) {
    overrides.tone_curve = core::tone_curve_from_name(*name);
    if (!overrides.tone_curve) return invalid("tone_curve", "must be none, aces or agx");
  }
  return core::resolve_display(job.display(), overrides);
}

core::Result<core::PixelRect> region_of(const core::PixelRect& window, const http::Request& request) {
  const auto text = request.parameter("region");
  if (!text) return window;
  const auto region = view::parse_region(*text);
  if (!region) return core::fail(region.error());
  if (!window.contains(*region)) return invalid("region", "must lie within the image");
  return *region;
}

// The part of the scene's name that is safe in a header.
std::string file_name(const std::string& name, std::string_view ending) {
  std::string safe;
  for (const char c : name)
    safe += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ? c : '_';
  return fmt::format("{}.{}", safe, ending);
}

}  // namespace

core::Result<http::Response> local_image(const LocalJob& job, view::TileSource& source,
                                         const http::Request& request) {
  const std::string ending = request.parameter("format").value_or("png");
  const auto format = core::image_format_from_path("image." + ending);
  if (!format) return invalid("format", "must be png, exr, hdr or pfm");
  const auto display = display_of(job, request);
  if (!display) return core::fail(display.error());
  const core::TileGrid grid = *source.grid();
  const auto region = region_of(grid.window(), request);
  if (!region) return core::fail(region.error());
  const auto layer = view::parse_layer(request.parameter("layer").value_or(""));
  if (!layer) return core::fail(layer.error());
  if (auto there = view::check_layer(source.layers(), *layer); !there) return core::fail(there.error());
  view::TileRows rows(source, grid, *region, *layer);
  StringSink sink;
  const auto size = core::write_image(rows.rows(job.settings().width_px, job.settings().height_px), *format,
                                      *display, sink);
  if (!size) return core::fail(size.error());
  const std::string disposition =
      fmt::format("attachment; filename=\"{}\"", file_name(job.name(), core::image_format_name(*format)));
  return http::Response{.headers = {{"Content-Type", "application/octet-stream"},
                                    {"Content-Disposition", disposition},
                                    {"Cache-Control", "no-store"}},
                        .body = sink.take()};
}

}  // namespace tessera::client
