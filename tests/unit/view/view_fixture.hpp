// SPDX-License-Identifier: Apache-2.0
// A film with made-up samples, and readers of what is sent of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/film/film.hpp"
#include "core/view/film_source.hpp"

namespace tessera::view {

// A film of 150 x 130 pixels, a window of an image of 200 x 200, that is shown while it grows.
class GrowingFilm {
 public:
  GrowingFilm();

  // Adds samples [begin, begin + count) to a tile.
  void add(int tile, std::uint32_t begin, std::uint32_t count);
  void add_to_all(std::uint32_t begin, std::uint32_t count);

  core::Film film;
  std::uint64_t header_revision = 1;
  FilmSource source;
};

std::string inflate_zlib(const std::string& bytes, std::size_t size);
std::vector<std::uint16_t> halves(const std::string& zlib, std::size_t count);

struct Frame {
  std::string header, payload;
};
// Adds a failure if the bytes are no frames.
std::vector<Frame> parse_frames(const std::string& bytes);

struct SentTile {
  core::PixelRect rect;
  int level = 0;
  Revision revision = 0;
  std::uint32_t samples = 0;
  std::string pixels;
};
// The tiles of these frames, also of those that share one.
std::vector<SentTile> tiles_in(const std::vector<Frame>& frames);

}  // namespace tessera::view
