#include "core/integrators/render.hpp"

#include <omp.h>
#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/integrators/caustic_guide.hpp"
#include "core/integrators/path.hpp"
#include "core/integrators/whitted.hpp"
#include "core/math/lane_array.hpp"
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

// One thread's work: takes samples a batch at a time and adds them to the film, in any order.
class Renderer {
 public:
  Renderer(const Scene& scene, const RenderSettings& settings, const LightGuide* guide)
      : scene_(scene), settings_(settings), path_tracer_(scene, settings, guide) {
    samples_.reserve(kBatchPaths);
    samplers_.reserve(kBatchPaths);
  }

  // A sample's place is in the buffers of a film tile; it is deposited there by flush() at the latest.
  void add(SampleId id, PixelSums pixel) {
    samples_.push_back({id, pixel});
    samplers_.emplace_back(settings_.seed, id.x, id.y, id.sample);
    if (samples_.size() == kBatchPaths) flush();
  }

  void flush() {
    take_samples();
    for (std::size_t i = 0; i < samples_.size(); ++i) deposit_or_report(i);
    samples_.clear();
    samplers_.clear();
  }

  // Of one sample, while there are no others.
  Rgb radiance_of(SampleId id) {
    samplers_.assign(1, Sampler(settings_.seed, id.x, id.y, id.sample));
    samples_.assign(1, {id, {}});
    take_samples();
    return radiance_[0];
  }

  const RenderCounters& counters() const { return counters_; }

 private:
  struct Sample {
    SampleId id;
    PixelSums pixel;
  };

  void take_samples() {
    const std::size_t count = samples_.size();
    for (std::size_t i = 0; i < count; i += kLaneCount) find_camera_rays(i, std::min(kLaneCount, count - i));
    const std::span<Rgb> radiance{radiance_.data(), count};
    counters_.samples += count;
    if (settings_.integrator != Integrator::kWhitted)
      return path_tracer_.trace({camera_rays_.data(), count}, samplers_, radiance, counters_);
    for (std::size_t i = 0; i < count; ++i)
      radiance[i] = trace_whitted(scene_, settings_, samplers_[i], camera_rays_[i], counters_);
  }

  void find_camera_rays(std::size_t first, std::size_t count) {
    std::array<const Sampler*, kLaneCount> samplers;
    for (std::size_t i = 0; i < kLaneCount; ++i) samplers[i] = &samplers_[first + (i < count ? i : 0)];
    const auto pads = Sampler::pads(samplers, kCameraPad);
    const FloatLanes u_x(pads[0]), u_y(pads[1]), lens_u(pads[2]), lens_v(pads[3]);
    for (std::size_t i = 0; i < count; ++i) {
      const SampleId id = samples_[first + i].id;
      const Vec2 raster = sample_raster(settings_.filter, id.x, id.y, {u_x[i], u_y[i]});
      camera_rays_[first + i] =
          scene_.camera().ray(raster, settings_.width_px, settings_.height_px, {lens_u[i], lens_v[i]});
    }
  }

  void deposit_or_report(std::size_t i) {
    const auto& [id, pixel] = samples_[i];
    if (can_be_counted(radiance_[i]))
      return deposit(radiance_[i], samplers_[i], id.sample % 2 == 1, pixel, counters_);
    RenderCounters lost;
    lost.non_finite_samples = 1;
    lost.first_non_finite = id;
    counters_.add(lost);
  }

  const Scene& scene_;
  const RenderSettings settings_;
  PathTracer path_tracer_;
  RenderCounters counters_;
  std::vector<Sample> samples_;    // of the batch
  std::vector<Sampler> samplers_;  // theirs
  std::array<Ray, kBatchPaths> camera_rays_;
  std::array<Rgb, kBatchPaths> radiance_;
};

void render_block(PixelRect block, FilmTile& tile, Renderer& renderer) {
  const auto width = static_cast<std::size_t>(tile.rect.width());
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; ++x) {
      const auto row = static_cast<std::size_t>(y - tile.rect.y0),
                 column = static_cast<std::size_t>(x - tile.rect.x0);
      const std::size_t offset = 3 * (row * width + column);
      for (std::uint32_t s = tile.range.begin; s < tile.range.end; ++s)
        renderer.add({x, y, s}, {tile.sums.data() + offset, tile.odd_sums.data() + offset});
    }
  }
}

}  // namespace

FilmTile render(const Scene& scene, const RenderSettings& settings, PixelRect rect, SampleRange range,
                int threads) {
  FilmTile tile(rect, range);
  const TileGrid blocks(rect, kBlockPx);
  const int team = std::clamp(threads, 1, blocks.tile_count());
  std::vector<RenderCounters> counters(static_cast<std::size_t>(team));
  const LightGuide* guide = caustic_guide(scene, settings, threads);
#pragma omp parallel num_threads(team)
  {
    const auto renderer = std::make_unique<Renderer>(scene, settings, guide);
#pragma omp for schedule(dynamic) nowait
    for (int b = 0; b < blocks.tile_count(); ++b) render_block(blocks.rect(b), tile, *renderer);
    renderer->flush();
    counters[static_cast<std::size_t>(omp_get_thread_num())] = renderer->counters();
  }
  for (const RenderCounters& of_thread : counters) tile.counters.add(of_thread);
  return tile;
}

Rgb render_sample(const Scene& scene, const RenderSettings& settings, SampleId id) {
  return std::make_unique<Renderer>(scene, settings, caustic_guide(scene, settings, 1))->radiance_of(id);
}

}  // namespace tessera::core
