// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/render.hpp"

#include <omp.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <memory>
#include <span>
#include <vector>

#include "core/base/parallel_errors.hpp"
#include "core/geometry/ray_lanes.hpp"
#include "core/integrators/path.hpp"
#include "core/integrators/sample_layers.hpp"
#include "core/math/lane_array.hpp"
#include "core/sampling/filter_warp.hpp"
#include "core/sampling/sampler.hpp"

namespace tessera::core::integrators {
namespace {

// Threads take blocks of this size in turn: small enough for load balancing, large enough for cache
// locality.
constexpr int kBlockPx = 8;

float sample_filter(PixelFilter filter, float u) {
  switch (filter.kind) {
    case FilterKind::kBox:
      return sampling::sample_box(u, filter.radius_px);
    case FilterKind::kTent:
      return sampling::sample_tent(u, filter.radius_px);
    case FilterKind::kGaussian:
      return sampling::sample_truncated_normal(u, filter.radius_px);
  }
  return 0;
}

// Samples positions in proportion to the filter, so that every sample has equal weight and the film is a
// plain sum.
Vec2 sample_raster(PixelFilter filter, int x, int y, Vec2 u) {
  return {static_cast<float>(x) + 0.5f + sample_filter(filter, u.x),
          static_cast<float>(y) + 0.5f + sample_filter(filter, u.y)};
}

bool can_be_counted(Rgb radiance) {
  return is_finite(radiance) && radiance.r >= 0 && radiance.g >= 0 && radiance.b >= 0;
}

// The location of a pixel in the buffers of a film tile.
struct PixelSums {
  std::uint64_t* sums;
  std::uint64_t* odd_sums;
};

void deposit(Rgb radiance, const sampling::Sampler& sampler, bool odd, PixelSums pixel,
             RenderCounters& counters) {
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

// The work of one thread: takes batches of samples and adds them to the film, in any order.
class Renderer {
 public:
  // The samples have the layers of the tile, which may be null if there are none.
  Renderer(const RenderPlan& plan, FilmTile* tile)
      : plan_(plan),
        scene_(plan.scene()),
        settings_(plan.settings()),
        samples_(kSamplesUnderWay),
        samplers_(kSamplesUnderWay, sampling::Sampler(settings_.seed, 0, 0, 0)),
        radiance_(kSamplesUnderWay),
        layers_(scene_, tile, kSamplesUnderWay),
        path_tracer_(plan, samplers_, radiance_, layers_.parts()) {
    for (std::uint32_t i = 0; i < kSamplesUnderWay; ++i) free_.push_back(kSamplesUnderWay - 1 - i);
    begun_.reserve(kBatchPaths);
  }

  // Starts a sample and returns its slot. `pixel` is where the sample is deposited, by flush() at the
  // latest.
  std::uint32_t add(SampleId id, PixelSums pixel) {
    const std::uint32_t number = free_.back();
    free_.pop_back();
    samples_[number] = {id, pixel};
    samplers_[number] = sampling::Sampler(settings_.seed, id.x, id.y, id.sample);
    begun_.push_back(number);
    if (begun_.size() == kBatchPaths) {
      send_camera_rays();
      while (free_.size() < kBatchPaths) deposit_some();
    }
    return number;
  }

  void flush() {
    send_camera_rays();
    while (free_.size() < kSamplesUnderWay) deposit_some();
  }

  // The radiance of a single sample; requires that no others are active.
  Rgb radiance_of(SampleId id) {
    std::array<std::uint64_t, 3> sums{}, odd_sums{};
    const std::uint32_t number = add(id, {sums.data(), odd_sums.data()});
    flush();
    return radiance_[number];
  }

  const RenderCounters& counters() const { return counters_; }
  SampleLayers& layers() { return layers_; }

 private:
  // Enough samples that mostly kBatchPaths of them are at the same depth, few enough for the caches.
  static constexpr std::uint32_t kSamplesUnderWay = 2048;

  struct Sample {
    SampleId id;
    PixelSums pixel;
  };

  void send_camera_rays() {
    for (std::size_t i = 0; i < begun_.size(); i += kLaneCount)
      send_batch(std::span(begun_).subspan(i, std::min(kLaneCount, begun_.size() - i)));
    if (plan_.lens_lights() != nullptr) path_tracer_.add_connections(counters_);
    counters_.samples += begun_.size();
    counters_.closest_hit_rays += layers_.add_surfaces();
    begun_.clear();
  }

  void send_batch(std::span<const std::uint32_t> numbers) {
    std::array<const sampling::Sampler*, kLaneCount> samplers;
    for (std::size_t i = 0; i < kLaneCount; ++i)
      samplers[i] = &samplers_[numbers[i < numbers.size() ? i : 0]];
    const auto pads = sampling::Sampler::pads(samplers, sampling::kCameraPad);
    const Vec2Of<FloatN> raster = rasters_of(numbers, {pads[0], pads[1]});
    const FloatN time = scene_.has_motion() ? sampling::Sampler::pads(samplers, sampling::kTimePad)[0] : 0.0f;
    const RayOf<FloatN> rays =
        scene_.camera_rays(raster, settings_.width_px, settings_.height_px, {pads[2], pads[3]}, time);
    if (layers_.see_surfaces()) begin_layers(numbers, rays);
    if (plan_.sample_tracer() != nullptr) return trace_samples(numbers, rays);
    if (plan_.lens_lights() == nullptr) return path_tracer_.begin(rays, numbers);
    const Vec3Lanes focuses = focuses_of(numbers.size(), raster, time);
    path_tracer_.begin(rays, numbers, focuses.all());
    connect_lens(numbers, samplers, focuses, FloatLanes(time));
  }

  // Where in the image each sample is. Lanes without a sample repeat the first.
  Vec2Of<FloatN> rasters_of(std::span<const std::uint32_t> numbers, Vec2Of<FloatN> u) const {
    const FloatLanes u_x(u.x), u_y(u.y);
    FloatLanes x, y;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const SampleId id = samples_[numbers[lane < numbers.size() ? lane : 0]].id;
      const Vec2 raster = sample_raster(settings_.filter, id.x, id.y, {u_x[lane], u_y[lane]});
      x.set(lane, raster.x), y.set(lane, raster.y);
    }
    return {x.all(), y.all()};
  }

  [[gnu::noinline]] void begin_layers(std::span<const std::uint32_t> numbers, const RayOf<FloatN>& rays) {
    const RayLanes of_lanes(rays);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      layers_.begin(of_lanes[i], samples_[numbers[i]].id, samplers_[numbers[i]]);
  }

  void trace_samples(std::span<const std::uint32_t> numbers, const RayOf<FloatN>& rays) {
    const RayLanes of_lanes(rays);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::uint32_t number = numbers[i];
      radiance_[number] =
          plan_.sample_tracer()(plan_, samplers_[number], of_lanes[i], counters_, layers_.parts_of(number));
      deposit_or_report(number);
    }
  }

  // The points in focus of `count` points of the image. Apart, as what few scenes need.
  [[gnu::noinline]] Vec3Lanes focuses_of(std::size_t count, Vec2Of<FloatN> raster, FloatN time) const {
    const FloatLanes x(raster.x), y(raster.y), times(time);
    Vec3Lanes focuses(Vec3Of<FloatN>{});
    for (std::size_t i = 0; i < count; ++i)
      focuses.set(i, scene_.with_camera(times[i], [&](const Camera& camera) {
        return camera.focus({x[i], y[i]}, settings_.width_px, settings_.height_px);
      }));
    return focuses;
  }

  [[gnu::noinline]] void connect_lens(std::span<const std::uint32_t> numbers,
                                      const std::array<const sampling::Sampler*, kLaneCount>& samplers,
                                      const Vec3Lanes& focuses, const FloatLanes& time) {
    const auto pads = sampling::Sampler::pads(samplers, sampling::kLensLightPad);
    const FloatLanes u(pads[0]), v(pads[1]), coarse(pads[2]), fine(pads[3]);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto connection = plan_.lens_lights()->connect(settings_.heuristic, focuses[i], time[i],
                                                           {u[i], v[i], coarse[i], fine[i]});
      if (connection) path_tracer_.connect(numbers[i], *connection);
    }
  }

  // Deposits samples whose paths end in the next step.
  void deposit_some() {
    for (const std::uint32_t number : path_tracer_.step(counters_)) deposit_or_report(number);
  }

  void deposit_or_report(std::uint32_t number) {
    free_.push_back(number);
    const auto& [id, pixel] = samples_[number];
    const Rgb radiance = radiance_[number];
    if (can_be_counted(radiance)) {
      layers_.add_light(number, id, samplers_[number]);
      return deposit(radiance, samplers_[number], id.sample % 2 == 1, pixel, counters_);
    }
    RenderCounters lost;
    lost.non_finite_samples = 1;
    lost.first_non_finite = id;
    counters_.add(lost);
  }

  const RenderPlan& plan_;
  const Scene& scene_;
  const RenderSettings& settings_;
  RenderCounters counters_;
  // Active samples by slot.
  std::vector<Sample> samples_;
  std::vector<sampling::Sampler> samplers_;
  std::vector<Rgb> radiance_;
  std::vector<std::uint32_t> free_;   // unused slots
  std::vector<std::uint32_t> begun_;  // samples whose camera rays are yet to be generated
  SampleLayers layers_;
  PathTracer path_tracer_;
};

// All words of the planes of the tile, so that threads can add to them.
void allocate_planes(FilmTile& tile) {
  const FilmLayout layout = film_layout(tile.layers);
  for (std::size_t i = 0; i < tile.planes.size(); ++i)
    if (layout.plane(i).encoding != ChannelEncoding::kIds) tile.planes[i].resize(tile.rect.pixel_count());
}

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

FilmTile render(const RenderPlan& plan, PixelRect rect, SampleRange range, int threads) {
  assert(plan.is_current());
  FilmTile tile(rect, range, plan.settings().layers);
  allocate_planes(tile);
  const TileGrid blocks(rect, kBlockPx);
  const int team = std::clamp(threads, 1, blocks.tile_count());
  std::vector<RenderCounters> counters(static_cast<std::size_t>(team));
  ParallelErrors errors;
#pragma omp parallel num_threads(team)
  {
    std::unique_ptr<Renderer> renderer;
    errors.run([&] { renderer = std::make_unique<Renderer>(plan, &tile); });
#pragma omp for schedule(dynamic) nowait
    for (int b = 0; b < blocks.tile_count(); ++b)
      errors.run([&] { render_block(blocks.rect(b), tile, *renderer); });
    errors.run([&] {
      renderer->flush();
      counters[static_cast<std::size_t>(omp_get_thread_num())] = renderer->counters();
    });
#pragma omp critical
    errors.run([&] { renderer->layers().finish(); });
  }
  errors.rethrow();
  for (Plane& plane : tile.planes) drop_zeros(plane);
  for (const RenderCounters& of_thread : counters) tile.counters.add(of_thread);
  return tile;
}

Rgb render_sample(const RenderPlan& plan, SampleId id) {
  assert(plan.is_current());
  return std::make_unique<Renderer>(plan, nullptr)->radiance_of(id);
}

}  // namespace tessera::core::integrators
