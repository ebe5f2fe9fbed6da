// SPDX-License-Identifier: Apache-2.0
// The frames of tile streams; docs/http-api.md describes them. Pure functions, but for JoinedTiles, which is
// not thread-safe.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/film/region.hpp"
#include "core/view/encoded_tiles.hpp"

namespace tessera::view {

// From this level on, tiles have at most 8 x 8 pixels, and many of them share a frame, uncompressed.
inline constexpr int kFirstJoinedLevel = 3;

// How the tiles of a level are sent.
constexpr PixelFormat format_of_level(int level) {
  return level < kFirstJoinedLevel ? PixelFormat::kHalf : PixelFormat::kRawHalf;
}

// Appends a frame.
void append_frame(std::string& out, std::string_view header_json, std::string_view payload = {});
// Appends the frame of one tile, below kFirstJoinedLevel.
void append_tile(std::string& out, const core::PixelRect& rect, int level, const EncodedTile& tile);

// Tiles of a coarse level that are to share a frame.
class JoinedTiles {
 public:
  // Appends a frame to `out` if there are enough tiles for one, or if they are of another level.
  void add(std::string& out, const core::PixelRect& rect, int level, const EncodedTile& tile);
  // Appends the frame of those that are left, if there are some.
  void append_to(std::string& out);
  // Of those that are not appended yet.
  std::size_t size_bytes() const { return tiles_.size() + pixels_.size(); }

 private:
  int level_ = 0;
  std::string tiles_;   // their part of the header
  std::string pixels_;  // one after another
};

}  // namespace tessera::view
