#include "core/integrators/render.hpp"

#include <omp.h>
#include <algorithm>
#include <vector>

#include "core/integrators/path.hpp"
#include "core/integrators/whitted.hpp"
#include "core/sampling/filter_warp.hpp"
#include "core/sampling/sampler.hpp"

namespace tessera::core {
namespace {

// Threads take blocks of this size in turn: small enough to share the work, large enough to stay in the
// caches.
constexpr int kBlockPx = 8;

float sample_filter(PixelFilter filter, float u) {
  switch (filter.kind) {
    case FilterKind::kBox:
      return sample_box(u, filter.radius_px);
    case FilterKind::kTent:
      return sample_tent(u, filter.radius_px);
    case FilterKind::kGaussian:
      return sample_truncated_normal(u, filter.radius_px);
  }
  return 0;
}

// Places are distributed as the filter is shaped: every sample counts alike, and the film stays a plain sum.
Vec2 sample_raster(PixelFilter filter, int x, int y, Vec2 u) {
  return {static_cast<float>(x) + 0.5f + sample_filter(filter, u.x),
          static_cast<float>(y) + 0.5f + sample_filter(filter, u.y)};
}

Rgb take_sample(const Scene& scene, const RenderSettings& settings, const Sampler& sampler, int x, int y,
                RenderCounters& counters) {
  const auto u = sampler.pad(kCameraPad);
  const Vec2 raster = sample_raster(settings.filter, x, y, {u[0], u[1]});
  const Ray ray = scene.camera().ray(raster, settings.width_px, settings.height_px, {u[2], u[3]});
  ++counters.samples;
  return settings.integrator == Integrator::kWhitted ? trace_whitted(scene, settings, sampler, ray, counters)
                                                     : trace_path(scene, settings, sampler, ray, counters);
}

bool can_be_counted(Rgb radiance) {
  return is_finite(radiance) && radiance.r >= 0 && radiance.g >= 0 && radiance.b >= 0;
}

// One pixel's place in the buffers of a film tile.
struct PixelSums {
  std::uint64_t* sums;
  std::uint64_t* odd_sums;
};

void deposit(Rgb radiance, const Sampler& sampler, bool odd, PixelSums pixel, RenderCounters& counters) {
  const auto dither = sampler.film_dither();
  bool saturated = false;
  for (int c = 0; c < 3; ++c) {
    const std::uint64_t value =
        to_fixed_point(static_cast<double>(radiance[c]), dither[static_cast<std::size_t>(c)]);
    saturated |= value == kFilmSaturated;
    pixel.sums[c] = add_saturating(pixel.sums[c], value);
    if (odd) pixel.odd_sums[c] = add_saturating(pixel.odd_sums[c], value);
  }
  counters.saturated_samples += saturated ? 1 : 0;
}

void render_pixel(const Scene& scene, const RenderSettings& settings, int x, int y, SampleRange range,
                  PixelSums pixel, RenderCounters& counters) {
  for (std::uint32_t s = range.begin; s < range.end; ++s) {
    const Sampler sampler(settings.seed, x, y, s);
    const Rgb radiance = take_sample(scene, settings, sampler, x, y, counters);
    if (can_be_counted(radiance)) {
      deposit(radiance, sampler, s % 2 == 1, pixel, counters);
    } else {
      RenderCounters lost;
      lost.non_finite_samples = 1;
      lost.first_non_finite = SampleId{x, y, s};
      counters.add(lost);
    }
  }
}

void render_block(const Scene& scene, const RenderSettings& settings, PixelRect block, FilmTile& tile,
                  RenderCounters& counters) {
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; ++x) {
      const auto row =
          static_cast<std::size_t>(y - tile.rect.y0) * static_cast<std::size_t>(tile.rect.width());
      const std::size_t offset = 3 * (row + static_cast<std::size_t>(x - tile.rect.x0));
      render_pixel(scene, settings, x, y, tile.range,
                   {tile.sums.data() + offset, tile.odd_sums.data() + offset}, counters);
    }
  }
}

}  // namespace

FilmTile render(const Scene& scene, const RenderSettings& settings, PixelRect rect, SampleRange range,
                int threads) {
  FilmTile tile(rect, range);
  const TileGrid blocks(rect.width(), rect.height(), kBlockPx);
  const int team = std::clamp(threads, 1, blocks.tile_count());
  std::vector<RenderCounters> counters(static_cast<std::size_t>(team));
#pragma omp parallel num_threads(team)
  {
    RenderCounters mine;
#pragma omp for schedule(dynamic)
    for (int b = 0; b < blocks.tile_count(); ++b) {
      const PixelRect local = blocks.rect(b);
      render_block(scene, settings,
                   {rect.x0 + local.x0, rect.y0 + local.y0, rect.x0 + local.x1, rect.y0 + local.y1}, tile,
                   mine);
    }
    counters[static_cast<std::size_t>(omp_get_thread_num())] = mine;
  }
  for (const RenderCounters& of_thread : counters) tile.counters.add(of_thread);
  return tile;
}

Rgb render_sample(const Scene& scene, const RenderSettings& settings, SampleId id) {
  RenderCounters counters;
  return take_sample(scene, settings, Sampler(settings.seed, id.x, id.y, id.sample), id.x, id.y, counters);
}

}  // namespace tessera::core
