// SPDX-License-Identifier: Apache-2.0
#include "client/page/local_image.hpp"

#include <fmt/format.h>

#include <charconv>
#include <string>
#include <string_view>
#include <utility>

#include "core/film/develop.hpp"
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

// A part of the image is what a render of this crop window writes.
core::TextAttributes attributes_of(const ImageHeader& header, const core::PixelRect& region, bool complete) {
  core::RenderRecord record = header.record;
  record.settings.crop = region;
  record.complete = complete;
  core::TextAttributes attributes = core::attributes_of(record);
  attributes.insert(attributes.end(), header.attributes.begin(), header.attributes.end());
  return attributes;
}

// The beauty with all layers.
core::Result<std::uint64_t> write_layers(view::TileSource& source, const core::PixelRect& region,
                                         core::ChannelRows channels, core::ImageFormat format,
                                         const core::DisplaySettings& display, core::ByteSink& sink) {
  const core::LayerSet layers = source.layers();
  core::LayerRows rows(*source.grid(), region, layers,
                       [&source](int tile) -> core::Result<core::Film::TileSums> {
                         auto read = source.read({0, tile});
                         if (!read) return core::fail(read.error());
                         return std::move(read->sums);
                       });
  channels.channels = core::image_channels(layers);
  channels.row = [&rows](int y) { return rows.row(y); };
  return core::write_channels(channels, format, display, sink);
}

}  // namespace

core::Result<http::Response> local_image(const LocalJob& job, view::TileSource& source,
                                         const ImageHeader& header, const http::Request& request) {
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
  core::TextAttributes attributes;
  if (!*layer) attributes = attributes_of(header, *region, job.has_all_samples());
  view::TileRows beauty(source, grid, *region, *layer);
  core::RowSource rows = beauty.rows(job.settings().width_px, job.settings().height_px);
  rows.attributes = attributes;
  StringSink sink;
  const auto size =
      *layer || source.layers().empty()
          ? core::write_image(rows, *format, *display, sink)
          : write_layers(source, *region, {rows.width, rows.height, {}, {}, rows.position, attributes},
                         *format, *display, sink);
  if (!size) return core::fail(size.error());
  const std::string disposition =
      fmt::format("attachment; filename=\"{}\"", file_name(job.name(), core::image_format_name(*format)));
  return http::Response{.headers = {{"Content-Type", "application/octet-stream"},
                                    {"Content-Disposition", disposition},
                                    {"Cache-Control", "no-store"}},
                        .body = sink.take()};
}

}  // namespace tessera::client
