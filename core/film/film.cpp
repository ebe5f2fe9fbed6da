// SPDX-License-Identifier: Apache-2.0
#include "core/film/film.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <tuple>
#include <utility>

#include "core/film/estimates.hpp"

namespace tessera::core {
namespace {

std::size_t channel_count(const PixelRect& rect) {
  return rect.pixel_count() * 3;
}

void add_row(std::uint64_t* to, const std::uint64_t* from, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] = add_saturating(to[i], from[i]);
}

// Hands the part of `rect` that lies in `cell`, a grid tile's rectangle, to `take`, a function of that grid
// tile's buffer.
using TakeTerms = void (SumBuffer::*)(std::size_t, std::span<const std::uint64_t>);
void for_overlap(SumBuffer& to, TakeTerms take, PixelRect cell, std::span<const std::uint64_t> from,
                 PixelRect rect) {
  if (rect == cell) return (to.*take)(0, from);
  const auto cell_row = static_cast<std::size_t>(cell.width()) * 3;
  const auto rect_row = static_cast<std::size_t>(rect.width()) * 3;
  for (int y = cell.y0; y < cell.y1; ++y) {
    const auto to_offset = static_cast<std::size_t>(y - cell.y0) * cell_row;
    const auto from_offset =
        static_cast<std::size_t>(y - rect.y0) * rect_row + static_cast<std::size_t>(cell.x0 - rect.x0) * 3;
    (to.*take)(to_offset, from.subspan(from_offset, cell_row));
  }
}

// Calls `visit` with the number and the rectangle of each grid tile that `rect` is a union of.
template <typename Visit>
void for_each_cell(const TileGrid& grid, const PixelRect& rect, Visit visit) {
  assert(grid.window().contains(rect));
  for (int y = rect.y0; y < rect.y1; y += grid.tile_px()) {
    for (int x = rect.x0; x < rect.x1; x += grid.tile_px()) {
      const int index = grid.tile_at(x, y);
      assert(rect.contains(grid.rect(index)));
      visit(static_cast<std::size_t>(index), grid.rect(index));
    }
  }
}

Image map_channels(const Film& film,
                   double (*value)(std::uint64_t, std::uint64_t, std::uint32_t, std::uint32_t)) {
  const TileGrid& grid = film.grid();
  const PixelRect& window = grid.window();
  Image image(window.width(), window.height());
  for (int t = 0; t < grid.tile_count(); ++t) {
    const PixelRect rect = grid.rect(t);
    const Film::TileSums tile = film.tile(t);
    if (tile.sums.empty()) continue;  // as black as the image is already
    std::size_t i = 0;
    const auto channel = [&] {
      const double v = value(tile.sums[i], tile.odd_sums[i], tile.samples, tile.odd_samples);
      ++i;
      return static_cast<float>(v);
    };
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x) {
        Rgb& pixel = image.at(x - window.x0, y - window.y0);
        pixel.r = channel();
        pixel.g = channel();
        pixel.b = channel();
      }
    }
  }
  return image;
}

}  // namespace

void RenderCounters::add(const RenderCounters& other) {
  samples += other.samples;
  closest_hit_rays += other.closest_hit_rays;
  shadow_rays += other.shadow_rays;
  non_finite_samples += other.non_finite_samples;
  saturated_samples += other.saturated_samples;
  const auto order = [](const SampleId& id) { return std::tuple(id.y, id.x, id.sample); };
  if (other.first_non_finite &&
      (!first_non_finite || order(*other.first_non_finite) < order(*first_non_finite)))
    first_non_finite = other.first_non_finite;
}

FilmTile::FilmTile(PixelRect tile_rect, SampleRange sample_range, LayerSet tile_layers)
    : rect(tile_rect),
      range(sample_range),
      sums(channel_count(tile_rect)),
      odd_sums(channel_count(tile_rect)),
      layers(tile_layers) {
  if (!layers.empty()) planes.resize(film_layout(layers).planes());
}

void FilmTile::append(const FilmTile& next) {
  assert(next.rect == rect && next.range.begin == range.end && next.layers == layers);
  add_row(sums.data(), next.sums.data(), sums.size());
  add_row(odd_sums.data(), next.odd_sums.data(), odd_sums.size());
  if (!layers.empty()) add_planes(film_layout(layers), planes, rect, next.planes, rect);
  range.end = next.range.end;
  counters.add(next.counters);
}

Film::Film(TileGrid grid, LayerSet layers)
    : grid_(grid),
      layers_(layers),
      layout_(film_layout(layers)),
      tiles_(static_cast<std::size_t>(grid.tile_count())) {
  for (int i = 0; i < grid.tile_count(); ++i) {
    const SumBuffer none(channel_count(grid.rect(i)));
    tiles_[static_cast<std::size_t>(i)] = {none, none, 0, 0, {}};
  }
}

void Film::add(const FilmTile& tile) {
  assert(tile.layers == layers_);
  for_each_cell(grid_, tile.rect, [&](std::size_t index, const PixelRect& cell) {
    Tile& to = tiles_[index];
    for_overlap(to.sums, &SumBuffer::add, cell, tile.sums, tile.rect);
    for_overlap(to.odd_sums, &SumBuffer::add, cell, tile.odd_sums, tile.rect);
    add_planes(layout_, to.planes, cell, tile.planes, tile.rect);
    to.samples += tile.range.count();
    to.odd_samples += tile.range.odd_count();
  });
}

Film::TileSums Film::tile(int index) const {
  const Tile& tile = tiles_[static_cast<std::size_t>(index)];
  if (tile.samples == 0) return {};
  return {tile.sums.values(), tile.odd_sums.values(), tile.samples, tile.odd_samples, tile.planes};
}

void Film::restore(int index, const TileSums& sums) {
  const SumBuffer none(channel_count(grid_.rect(index)));
  assert(sums.samples == 0 || (sums.sums.size() == none.size() && sums.odd_sums.size() == none.size()));
  Tile& tile = tiles_[static_cast<std::size_t>(index)];
  tile = {none, none, sums.samples, sums.odd_samples, {}};
  tile.sums.add(0, sums.sums);
  tile.odd_sums.add(0, sums.odd_sums);
  tile.planes = sums.planes;
}

Image Film::develop() const {
  return map_channels(*this, [](std::uint64_t sum, std::uint64_t, std::uint32_t samples, std::uint32_t) {
    return mean_radiance(sum, samples);
  });
}

Image Film::standard_error() const {
  return map_channels(*this, tessera::core::standard_error);
}

std::uint64_t Film::saturated_pixels() const {
  std::uint64_t count = 0;
  for (const Tile& tile : tiles_) {
    if (tile.samples == 0) continue;
    const std::vector<std::uint64_t> sums = tile.sums.values();
    for (std::size_t i = 0; i < sums.size(); i += 3)
      count += std::max({sums[i], sums[i + 1], sums[i + 2]}) == kFilmSaturated ? 1 : 0;
  }
  return count;
}

Image develop_tile(const PixelRect& rect, const Film::TileSums& sums) {
  Film alone(TileGrid(rect, std::max(rect.width(), rect.height())));
  alone.restore(0, sums);
  return alone.develop();
}

}  // namespace tessera::core
