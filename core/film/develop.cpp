// SPDX-License-Identifier: Apache-2.0
#include "core/film/develop.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <string_view>
#include <utility>

#include "core/film/estimates.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kRadianceChannels = 3;
constexpr std::string_view kCryptoComponents = "rgba";

void append_crypto_names(const std::string& layer, std::vector<std::string>& names) {
  for (int i = 0; i < 2 * kCryptoRanks; ++i)
    names.push_back(layer + "0" + std::to_string(i / 4) + "." +
                    kCryptoComponents[static_cast<std::size_t>(i % 4)]);
}

// Writes one channel after the other of all pixels of a tile.
class Developer {
 public:
  Developer(const Film::TileSums& tile, std::size_t pixels, std::size_t channels, std::span<float> to)
      : tile_(tile), pixels_(pixels), channels_(channels), to_(to) {
    assert(to.size() == pixels * channels);
  }

  template <typename ValueAt>
  void channel(const ValueAt& value_at) {
    for (std::size_t i = 0; i < pixels_; ++i) to_[i * channels_ + next_] = static_cast<float>(value_at(i));
    ++next_;
  }
  void radiance(std::size_t component) {
    channel([&](std::size_t i) {
      return tile_.sums.empty() ? 0
                                : mean_radiance(tile_.sums[i * kRadianceChannels + component], tile_.samples);
    });
  }
  void error(std::size_t component) {
    channel([&](std::size_t i) {
      const std::size_t at = i * kRadianceChannels + component;
      return tile_.sums.empty()
                 ? 0
                 : standard_error(tile_.sums[at], tile_.odd_sums[at], tile_.samples, tile_.odd_samples);
    });
  }
  void plane(const FilmChannel& film_channel, const Plane& plane) {
    if (film_channel.encoding == ChannelEncoding::kIds) return ids(plane);
    channel([&](std::size_t i) { return value(film_channel, plane.empty() ? 0 : plane[i]); });
  }
  bool complete() const { return next_ == channels_; }

 private:
  double value(const FilmChannel& film_channel, std::uint64_t word) const {
    const std::uint32_t samples = tile_.samples;
    switch (film_channel.encoding) {
      case ChannelEncoding::kSigned:
        return mean_signed(word, samples);
      case ChannelEncoding::kCount:
        return samples == 0 ? 0 : static_cast<double>(word) / samples;
      case ChannelEncoding::kNearest:
        if (film_channel.name != "Depth.Z") return nearest_number(word);
        return word == 0 ? kNoDepth : nearest_distance(word);
      default:
        return mean_radiance(word, samples);
    }
  }

  // The largest coverages of each pixel; of equal ones, the smaller id first.
  void ids(const Plane& plane) {
    constexpr auto kValues = static_cast<std::size_t>(2 * kCryptoRanks);
    for (std::size_t i = 0; i < pixels_; ++i) std::fill_n(to_.data() + i * channels_ + next_, kValues, 0.0f);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> ranks;
    for (std::size_t at = 0; at < plane.size();) {
      const std::uint64_t pixel = plane[at] >> 32;
      ranks.clear();
      for (; at < plane.size() && plane[at] >> 32 == pixel; at += 2)
        ranks.emplace_back(~plane[at + 1], static_cast<std::uint32_t>(plane[at]));
      std::sort(ranks.begin(), ranks.end());
      float* const values = to_.data() + pixel * channels_ + next_;
      for (std::size_t rank = 0; rank < std::min(ranks.size(), kValues / 2); ++rank) {
        values[2 * rank] = std::bit_cast<float>(ranks[rank].second);
        values[2 * rank + 1] =
            static_cast<float>(static_cast<double>(~ranks[rank].first) / std::max(tile_.samples, 1u));
      }
    }
    next_ += kValues;
  }

  const Film::TileSums& tile_;
  const std::size_t pixels_, channels_;
  const std::span<float> to_;
  std::size_t next_ = 0;  // the channel
};

}  // namespace

std::vector<std::string> image_channels(LayerSet layers) {
  std::vector<std::string> names;
  for (const FilmChannel& channel : film_layout(layers).channels) {
    if (channel.encoding == ChannelEncoding::kIds)
      append_crypto_names(channel.name, names);
    else
      names.push_back(channel.name);
  }
  if (layers.has(Layer::kSamples)) names.emplace_back("Debug Sample Count.X");
  if (layers.has(Layer::kStandardError))
    for (const char* const component : {"R", "G", "B"})
      names.push_back(std::string("StandardError.") + component);
  return names;
}

void develop_layers(LayerSet layers, const PixelRect& rect, const Film::TileSums& sums, std::span<float> to) {
  const FilmLayout layout = film_layout(layers);
  Developer developer(sums, rect.pixel_count(), image_channels(layers).size(), to);
  for (std::size_t i = 0; i < kRadianceChannels; ++i) developer.radiance(i);
  for (std::size_t i = 0; i < layout.planes(); ++i)
    developer.plane(layout.plane(i), sums.planes.empty() ? Plane() : sums.planes[i]);
  if (layers.has(Layer::kSamples)) developer.channel([&](std::size_t) { return sums.samples; });
  if (layers.has(Layer::kStandardError))
    for (std::size_t i = 0; i < kRadianceChannels; ++i) developer.error(i);
  assert(developer.complete());
}

LayerRows::LayerRows(const TileGrid& grid, const PixelRect& region, LayerSet layers, TileSource tile)
    : grid_(grid),
      region_(region),
      layers_(layers),
      tile_(std::move(tile)),
      channels_(image_channels(layers).size()),
      rows_(static_cast<std::size_t>(grid.tile_px()) * static_cast<std::size_t>(region.width()) * channels_) {
}

Result<const float*> LayerRows::row(int y) {
  const int y_of_window = region_.y0 + y - grid_.window().y0;
  const int tile_row = y_of_window / grid_.tile_px();
  if (tile_row_ != tile_row) {
    if (auto developed = develop(tile_row); !developed) return fail(developed.error());
  }
  const auto row_size = static_cast<std::size_t>(region_.width()) * channels_;
  return rows_.data() + static_cast<std::size_t>(y_of_window % grid_.tile_px()) * row_size;
}

Status LayerRows::develop(int tile_row) {
  tile_row_ = -1;
  std::vector<float> values;
  const int first = grid_.tile_at(region_.x0, region_.y0) % grid_.columns();
  const int last = grid_.tile_at(region_.x1 - 1, region_.y0) % grid_.columns();
  for (int column = first; column <= last; ++column) {
    const int index = tile_row * grid_.columns() + column;
    const PixelRect rect = grid_.rect(index);
    const auto sums = tile_(index);
    if (!sums) return fail(sums.error());
    values.resize(rect.pixel_count() * channels_);
    develop_layers(layers_, rect, *sums, values);
    const int x0 = std::max(rect.x0, region_.x0), x1 = std::min(rect.x1, region_.x1);
    const auto channels_at = [this](int row, int width, int x) {
      return (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
             channels_;
    };
    for (int row = 0; row < rect.height(); ++row)
      std::copy_n(values.data() + channels_at(row, rect.width(), x0 - rect.x0),
                  static_cast<std::size_t>(x1 - x0) * channels_,
                  rows_.data() + channels_at(row, region_.width(), x0 - region_.x0));
  }
  tile_row_ = tile_row;
  return {};
}

}  // namespace tessera::core
