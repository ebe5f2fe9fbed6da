// SPDX-License-Identifier: Apache-2.0
// Routes of small images and single pixels.
#include <algorithm>
#include <chrono>

#include "core/image/limits.hpp"
#include "core/view/thumbnails.hpp"
#include "core/view/tile_statistics.hpp"
#include "proto/convert_display.hpp"
#include "proto/text.hpp"
#include "server/http/answers.hpp"
#include "server/http/handlers.hpp"
#include "server/http/read_json.hpp"

namespace tessera::http_api {

namespace {

constexpr int kDefaultSizePx = 256;
// What cannot be read in this time is shown with the next request.
constexpr std::chrono::milliseconds kThumbnailTime{500};

core::Result<int> coordinate(const http::Request& request, const char* name) {
  const auto value = read_number(request, name, core::kMaxImageSidePx);
  if (!value) return core::fail(value.error());
  if (!*value) return core::fail(proto::invalid_field(name, "is missing"));
  return static_cast<int>(**value);
}

// The image of the job that is asked for.
core::Result<std::shared_ptr<watch::JobTiles>> source_of(const CallPtr& call) {
  const auto image = read_image_index(call->request);
  if (!image) return core::fail(image.error());
  return call->context.tiles.source(call->id(), *image);
}

}  // namespace

Answer get_thumbnail(const CallPtr& call) {
  const auto asked = read_number(call->request, "size", view::kMaxThumbnailPx);
  if (!asked) return core::fail(asked.error());
  const int size_px = std::max(1, static_cast<int>(asked->value_or(kDefaultSizePx)));
  const auto source = source_of(call);
  if (!source) return core::fail(source.error());
  const auto look = (*source)->look();
  if (!look) return core::fail(look.error());
  const auto display = proto::from_proto((*look)->job.display());
  if (!display) return core::fail(display.error());
  const auto thumbnail = call->context.tiles.thumbnails().get(
      **source, size_px, *display, std::chrono::steady_clock::now() + kThumbnailTime);
  if (!thumbnail) return core::fail(thumbnail.error());
  http::Response response{.headers = {{"ETag", (*thumbnail)->etag}, {"Cache-Control", "private, no-cache"}}};
  if (call->request.header("if-none-match") == (*thumbnail)->etag) {
    response.status = 304;
    return response;
  }
  response.headers.emplace_back("Content-Type", "image/png");
  response.body = (*thumbnail)->png;
  return response;
}

Answer get_pixel(const CallPtr& call) {
  const auto x = coordinate(call->request, "x");
  if (!x) return core::fail(x.error());
  const auto y = coordinate(call->request, "y");
  if (!y) return core::fail(y.error());
  const auto source = source_of(call);
  if (!source) return core::fail(source.error());
  const auto layer = view::parse_layer(call->request.parameter("layer").value_or(""));
  if (!layer) return core::fail(layer.error());
  const auto pixel = view::read_pixel(**source, *x, *y, *layer);
  if (!pixel) return core::fail(pixel.error());
  return json_text_response(view::to_json(*pixel));
}

}  // namespace tessera::http_api
