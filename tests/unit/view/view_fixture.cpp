// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/view/view_fixture.hpp"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/view/tile_pixels.hpp"

namespace tessera::view {
namespace {

std::uint32_t length_at(const std::string& bytes, std::size_t at) {
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + at, sizeof length);
  return length;
}

}  // namespace

GrowingFilm::GrowingFilm()
    : film(core::TileGrid({7, 11, 157, 141}, core::kTilePx)), source("job", film.grid(), [this] {
        return JobHeader{R"({"name":"job"})", header_revision};
      }) {
  source.attach(film);
}

void GrowingFilm::add(int tile, std::uint32_t begin, std::uint32_t count) {
  const core::PixelRect rect = film.grid().rect(tile);
  core::FilmTile samples(rect, {begin, begin + count});
  std::uint64_t noise = 88172645463325252u + static_cast<std::uint64_t>(tile) + begin;
  for (std::size_t i = 0; i < samples.sums.size(); ++i) {
    noise ^= noise << 13;
    noise ^= noise >> 7;
    noise ^= noise << 17;
    samples.odd_sums[i] = samples.range.odd_count() == 0 ? 0 : (noise >> 34) * samples.range.odd_count();
    samples.sums[i] = samples.odd_sums[i] + (noise & 0x3fffffff) * (count - samples.range.odd_count());
  }
  {
    const std::lock_guard lock(source.film_mutex());
    film.add(samples);
  }
  source.note_change(rect);
}

void GrowingFilm::add_to_all(std::uint32_t begin, std::uint32_t count) {
  for (int tile = 0; tile < film.grid().tile_count(); ++tile) add(tile, begin, count);
}

std::string inflate_zlib(const std::string& bytes, std::size_t size) {
  std::string inflated(size, '\0');
  libdeflate_decompressor* const inflater = libdeflate_alloc_decompressor();
  std::size_t count = 0;
  EXPECT_EQ(libdeflate_zlib_decompress(inflater, bytes.data(), bytes.size(), inflated.data(), size, &count),
            LIBDEFLATE_SUCCESS);
  EXPECT_EQ(count, size);
  libdeflate_free_decompressor(inflater);
  return inflated;
}

std::vector<std::uint16_t> halves(const std::string& zlib, std::size_t count) {
  const std::string bytes = inflate_zlib(zlib, count * sizeof(std::uint16_t));
  std::vector<std::uint16_t> values(count);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

std::vector<Frame> parse_frames(const std::string& bytes) {
  std::vector<Frame> frames;
  for (std::size_t at = 0; at < bytes.size();) {
    if (at + 8 > bytes.size()) {
      ADD_FAILURE() << "half a frame";
      break;
    }
    const std::size_t header = length_at(bytes, at), payload = length_at(bytes, at + 4);
    if (at + 8 + header + payload > bytes.size()) {
      ADD_FAILURE() << "half a frame";
      break;
    }
    frames.push_back({bytes.substr(at + 8, header), bytes.substr(at + 8 + header, payload)});
    at += 8 + header + payload;
  }
  return frames;
}

std::vector<SentTile> tiles_in(const std::vector<Frame>& frames) {
  std::vector<SentTile> tiles;
  for (const Frame& frame : frames) {
    const auto header = nlohmann::json::parse(frame.header);
    if (header["type"] == "tile")
      tiles.push_back({{header["x0"], header["y0"], header["x1"], header["y1"]},
                       header["level"],
                       header["revision"],
                       header["samples"],
                       frame.payload});
    if (header["type"] != "tiles") continue;
    const int level = header["level"];
    std::size_t at = 0;
    for (const auto& tile : header["tiles"]) {
      const core::PixelRect rect{tile[0], tile[1], tile[2], tile[3]};
      const auto size =
          static_cast<std::size_t>(6 * level_size(rect.width(), level) * level_size(rect.height(), level));
      tiles.push_back({rect, level, tile[4], tile[5], frame.payload.substr(at, size)});
      at += size;
    }
    EXPECT_EQ(at, frame.payload.size());
  }
  return tiles;
}

}  // namespace tessera::view
