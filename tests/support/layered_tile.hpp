// SPDX-License-Identifier: Apache-2.0
// Made-up samples of all layers: they depend on pixel and sample alone, as those of a render do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/film/film.hpp"
#include "core/film/layout.hpp"
#include "core/film/planes.hpp"

namespace tessera::test {

// Any hash function will do.
inline std::uint64_t made_up_bits(int x, int y, std::size_t channel, std::uint32_t sample) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15 +
                    static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4f + channel * 0x165667b19e3779f9 +
                    sample * std::uint64_t{0x27d4eb2f165667c5};
  h = (h ^ h >> 31) * 0x9fb21c651e98df25;
  return h ^ h >> 28;
}

// One sample of a plane that is not of ids.
inline std::uint64_t made_up_word(core::ChannelEncoding encoding, std::uint64_t bits) {
  switch (encoding) {
    case core::ChannelEncoding::kSigned:
      return core::to_signed_word(static_cast<double>(bits >> 40) / 0x1p22 - 2);
    case core::ChannelEncoding::kCount:
      return bits >> 63;
    case core::ChannelEncoding::kNearest:
      return core::to_nearest_word(static_cast<float>(bits >> 44),
                                   static_cast<std::uint32_t>(bits >> 60) + 1);
    default:
      return bits >> 38;
  }
}

// Fills the planes of a tile, whose layers are set.
inline void add_made_up_planes(core::FilmTile& tile) {
  const core::FilmLayout layout = core::film_layout(tile.layers);
  tile.planes.assign(layout.planes(), {});
  for (std::size_t i = 0; i < tile.planes.size(); ++i) {
    const core::ChannelEncoding encoding = layout.plane(i).encoding;
    const bool has_ids = encoding == core::ChannelEncoding::kIds;
    core::IdCounter ids(tile.rect);
    core::Plane words(has_ids ? 0 : tile.rect.pixel_count());
    for (std::uint32_t pixel = 0; pixel < tile.rect.pixel_count(); ++pixel) {
      const int x = tile.rect.x0 + static_cast<int>(pixel) % tile.rect.width();
      const int y = tile.rect.y0 + static_cast<int>(pixel) / tile.rect.width();
      for (std::uint32_t s = tile.range.begin; s < tile.range.end; ++s) {
        const std::uint64_t bits = made_up_bits(x, y, i, s);
        if (has_ids)
          ids.add(pixel, static_cast<std::uint32_t>(bits >> 62));  // of four, one of which is none
        else
          words[pixel] = core::combine(encoding, words[pixel], made_up_word(encoding, bits));
      }
    }
    tile.planes[i] = has_ids ? ids.take() : std::move(words);
    if (!has_ids) core::drop_zeros(tile.planes[i]);
  }
}

}  // namespace tessera::test
