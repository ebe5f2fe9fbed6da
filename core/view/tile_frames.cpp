// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_frames.hpp"

#include <fmt/format.h>

namespace tessera::view {
namespace {

// A few hundred tiles, which a page takes a few milliseconds for.
constexpr std::size_t kFrameBytes = 32 << 10;

void append_length(std::string& out, std::size_t length) {
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(length >> shift & 0xff);
}

}  // namespace

void append_frame(std::string& out, std::string_view header_json, std::string_view payload) {
  append_length(out, header_json.size());
  append_length(out, payload.size());
  out += header_json;
  out += payload;
}

void append_tile(std::string& out, const core::PixelRect& rect, int level, const EncodedTile& tile) {
  const std::string noise = tile.noise ? fmt::format("{}", *tile.noise) : "null";
  append_frame(
      out,
      fmt::format(
          R"({{"type":"tile","x0":{},"y0":{},"x1":{},"y1":{},"level":{},"revision":{},"samples":{},"noise":{}}})",
          rect.x0, rect.y0, rect.x1, rect.y1, level, tile.revision, tile.samples, noise),
      tile.pixels);
}

void JoinedTiles::add(std::string& out, const core::PixelRect& rect, int level, const EncodedTile& tile) {
  if (level != level_ || size_bytes() >= kFrameBytes) append_to(out);
  level_ = level;
  tiles_ += fmt::format("{}[{},{},{},{},{},{}]", tiles_.empty() ? "" : ",", rect.x0, rect.y0, rect.x1,
                        rect.y1, tile.revision, tile.samples);
  pixels_ += tile.pixels;
}

void JoinedTiles::append_to(std::string& out) {
  if (tiles_.empty()) return;
  append_frame(out, fmt::format(R"({{"type":"tiles","level":{},"tiles":[{}]}})", level_, tiles_), pixels_);
  tiles_.clear();
  pixels_.clear();
}

}  // namespace tessera::view
