// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/ready_tiles.hpp"

#include <random>

#include "core/film/film.hpp"
#include "core/film/layout.hpp"
#include "proto/tile_codec.hpp"

namespace tessera::bench {
namespace {

constexpr core::PixelRect kTile{0, 0, core::kTilePx, core::kTilePx};

// Used for every range. Sums of fewer samples compress better, those of more only slightly worse.
constexpr std::uint32_t kSamples = 16;
constexpr std::uint32_t kVariants = 16;

// Some of the samples find no light; the others vary by a decade around a mean that changes slowly between
// pixels.
class Noise {
 public:
  explicit Noise(std::uint32_t seed) : random_(seed) {}

  std::uint64_t sum(std::uint32_t samples, double mean_radiance) {
    double radiance = 0;
    for (std::uint32_t i = 0; i < samples; ++i)
      if (!dark_(random_)) radiance += mean_radiance * spread_(random_);
    return core::to_fixed_point(radiance, 0.5);
  }

 private:
  std::mt19937 random_;
  std::bernoulli_distribution dark_{0.15};
  std::lognormal_distribution<double> spread_{-0.3, 0.8};
};

// How many of a range's samples are odd.
enum Odd : std::size_t { kNone, kSome, kAll };

Odd odd_samples(const core::SampleRange& range) {
  return range.odd_count() == 0 ? kNone : range.odd_count() == range.count() ? kAll : kSome;
}

// As of flat surfaces, which compress to next to nothing.
void fill_planes(core::FilmTile& tile, std::uint32_t seed) {
  constexpr std::uint64_t kStep = std::uint64_t{kSamples} << 20;
  tile.planes.assign(core::film_layout(tile.layers).planes(), {});
  for (core::Plane& plane : tile.planes) plane.assign(kTile.pixel_count(), (1 + seed++ % kVariants) * kStep);
}

core::FilmTile noisy_tile(std::uint32_t seed, Odd odd, const core::LayerSet& layers) {
  Noise noise(seed);
  core::FilmTile tile(kTile, {0, kSamples}, layers);
  fill_planes(tile, seed);
  constexpr std::size_t kRow = std::size_t{core::kTilePx} * 3;
  for (std::size_t i = 0; i < tile.sums.size(); ++i) {
    const double across = static_cast<double>(i % kRow) / kRow,
                 down = static_cast<double>(i / kRow) / core::kTilePx;
    const double mean_radiance = 0.05 + 0.5 * across * down;
    tile.odd_sums[i] = odd == kNone ? 0 : noise.sum(kSamples / 2, mean_radiance);
    tile.sums[i] = tile.odd_sums[i] + (odd == kAll ? 0 : noise.sum(kSamples / 2, mean_radiance));
  }
  return tile;
}

}  // namespace

ReadyTiles::ReadyTiles(const core::LayerSet& layers) {
  for (const Odd odd : {kNone, kSome, kAll})
    for (std::uint32_t seed = 0; seed < kVariants; ++seed) {
      v1::RenderedItem item = proto::encode_tile(noisy_tile(seed, odd, layers));
      frames_[odd].push_back({std::move(*item.mutable_planes_zstd()),
                              {item.plane_words().begin(), item.plane_words().end()},
                              item.sums_xxh3()});
    }
}

v1::RenderedItem ReadyTiles::rendered(const proto::WorkItem& item, std::uint64_t variant) const {
  const Frame& frame = frames_[odd_samples(item.range)][variant % kVariants];
  core::RenderCounters counters;
  counters.samples = item.rect.pixel_count() * item.range.count();
  counters.closest_hit_rays = 3 * counters.samples;
  counters.shadow_rays = 2 * counters.samples;

  v1::RenderedItem message;
  *message.mutable_item() = proto::to_proto(item);
  message.set_planes_zstd(frame.planes_zstd);
  message.mutable_plane_words()->Assign(frame.plane_words.begin(), frame.plane_words.end());
  message.set_sums_xxh3(frame.sums_xxh3);
  *message.mutable_counters() = proto::to_proto(counters);
  return message;
}

}  // namespace tessera::bench
