// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_statistics.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "core/film/estimates.hpp"
#include "core/view/tile_frames.hpp"

namespace tessera::view {
namespace {

std::string to_json(const core::Rgb& color) {
  return fmt::format("[{},{},{}]", color.r, color.g, color.b);
}

std::string to_json(const LayerValues& layer) {
  std::string channels, values;
  for (std::size_t i = 0; i < layer.channels.size(); ++i) {
    const char* const comma = i == 0 ? "" : ",";
    channels += fmt::format("{}\"{}\"", comma, layer.channels[i]);
    values += comma + (std::isfinite(layer.values[i]) ? fmt::format("{}", layer.values[i]) : "null");
  }
  return fmt::format(R"(,"layer":{{"channels":[{}],"values":[{}]}})", channels, values);
}

tl::unexpected<core::Error> no_image() {
  return core::fail(core::ErrorCode::kFailedPrecondition, "the job has no image yet");
}

}  // namespace

std::optional<float> relative_noise(const core::Film::TileSums& sums) {
  if (sums.odd_samples == 0 || sums.odd_samples == sums.samples) return std::nullopt;
  double squares = 0, total = 0;
  for (std::size_t i = 0; i < sums.sums.size(); ++i) {
    const double error = core::standard_error(sums.sums[i], sums.odd_sums[i], sums.samples, sums.odd_samples);
    squares += error * error;
    total += core::mean_radiance(sums.sums[i], sums.samples);
  }
  if (total <= 0) return std::nullopt;
  const auto count = static_cast<double>(sums.sums.size());
  return static_cast<float>(std::sqrt(squares / count) / (total / count));
}

core::Result<PixelValue> read_pixel(TileSource& source, int x, int y, const ShownLayer& layer) {
  const auto grid = source.grid();
  if (!grid) return no_image();
  if (!grid->window().contains({x, y, x + 1, y + 1}))
    return core::fail(core::ErrorCode::kOutOfRange, fmt::format("pixel ({}, {}) is outside the image", x, y));
  if (auto there = check_layer(source.layers(), layer); !there) return core::fail(there.error());
  const int tile = grid->tile_at(x, y);
  const core::PixelRect rect = grid->rect(tile);
  const auto read = source.read({0, tile});
  if (!read) return core::fail(read.error());
  const core::Film::TileSums& sums = read->sums;
  PixelValue pixel{x, y, {}, sums.samples, {}};
  if (layer) pixel.layer = layer_values(read->layers, *layer, rect, sums, x, y);
  if (sums.samples == 0) return pixel;
  const auto first = 3 * (static_cast<std::size_t>(y - rect.y0) * static_cast<std::size_t>(rect.width()) +
                          static_cast<std::size_t>(x - rect.x0));
  const auto value = [&](std::size_t channel) {
    return static_cast<float>(core::mean_radiance(sums.sums[first + channel], sums.samples));
  };
  const auto error = [&](std::size_t channel) {
    return static_cast<float>(core::standard_error(sums.sums[first + channel], sums.odd_sums[first + channel],
                                                   sums.samples, sums.odd_samples));
  };
  pixel.value = {value(0), value(1), value(2)};
  pixel.standard_error = {error(0), error(1), error(2)};
  return pixel;
}

std::string to_json(const PixelValue& pixel) {
  return fmt::format(R"({{"x":{},"y":{},"value":{},"samples":{},"standard_error":{}{}}})", pixel.x, pixel.y,
                     to_json(pixel.value), pixel.samples, to_json(pixel.standard_error),
                     pixel.layer ? to_json(*pixel.layer) : "");
}

core::Result<std::vector<std::optional<TileState>>> read_tile_states(
    TileSource& source, EncodedTiles& tiles, std::chrono::steady_clock::time_point deadline) {
  const auto grid = source.grid();
  if (!grid) return no_image();
  const auto count = static_cast<std::size_t>(grid->tile_count());
  const auto changes = source.changes_since(0, count);
  if (!changes) return core::fail(changes.error());
  std::vector<std::optional<TileState>> states(count, TileState{});
  for (const TileChange& change : *changes) {
    auto& state = states[static_cast<std::size_t>(change.tile)];
    state.reset();
    if (std::chrono::steady_clock::now() >= deadline) continue;
    const auto tile =
        tiles.get({source.id(), change.tile, format_of_level(kMaxLevel), kMaxLevel}, change.revision,
                  grid->rect(change.tile), [&] { return source.read(change); });
    if (!tile) return core::fail(tile.error());
    state = TileState{(*tile)->samples, (*tile)->noise};
  }
  return states;
}

}  // namespace tessera::view
