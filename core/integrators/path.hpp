// Path tracing (Kajiya 1986), many paths at a time: one sample of the radiance that arrives along each of a
// batch of camera rays. All paths of a batch take each step together (Laine, Karras and Aila 2013), so that
// rays are traced, and surfaces shaded, in long runs of the same work. What a path finds does not depend on
// those beside it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/film/film.hpp"
#include "core/guiding/light_guide.hpp"
#include "core/integrators/path_queue.hpp"
#include "core/integrators/vertex.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// Unbiased whatever the strategy, but for settings.max_depth. Large: not for the stack. Serves one thread.
class PathTracer {
 public:
  // `guide` may be null; `naive` has none.
  PathTracer(const Scene& scene, const RenderSettings& settings, const LightGuide* guide);

  // radiance[i] of rays[i], with the random numbers of samplers[i]. The spans are of the same size, at most
  // kBatchPaths. Rays are counted in `counters`.
  void trace(std::span<const Ray> rays, std::span<const Sampler> samplers, std::span<Rgb> radiance,
             RenderCounters& counters);

 private:
  // Light on its way to a vertex, if nothing is in between.
  struct Connection {
    std::uint32_t path;
    Rgb radiance;  // what the path gains
  };

  void step(int depth, RenderCounters& counters);
  void add_environment(const PathHead& head, Vec3 direction);
  void add_emission(const PathHead& head, const PathVertex& vertex, std::uint32_t light);
  template <typename Pdf>
  float weight_of_found(std::uint32_t light, const PathHead& head, Pdf pdf) const;
  using Cell = LightGuide::Cell;
  const Cell* guide_at(const PathVertex& vertex) const;
  void connect_to_light(const PathHead& head, const PathVertex& vertex, const Cell* cell, int depth);
  void scatter(PathHead head, const PathVertex& vertex, const Cell* cell, int depth);
  std::optional<PathVertex::Scattered> choose_direction(PathHead& head, const PathVertex& vertex,
                                                        const Cell& cell, Vec2 u, float u_lobe) const;
  void add_unoccluded(RenderCounters& counters);

  const Scene& scene_;
  const RenderSettings settings_;
  const LightSampler& light_sampler_;
  const LightGuide* guide_;

  std::span<const Sampler> samplers_;  // of the batch's paths
  std::span<Rgb> radiance_;
  std::array<PathQueue, 2> queues_;
  PathQueue *paths_ = &queues_[0], *next_paths_ = &queues_[1];
  std::array<Hit, kBatchPaths> hits_;  // of the rays of paths_
  std::size_t connection_count_ = 0;
  std::array<Ray, kBatchPaths> shadow_rays_;
  std::array<Connection, kBatchPaths> connections_;  // of shadow_rays_
  std::array<std::uint8_t, kBatchPaths> occluded_;   // likewise
};

}  // namespace tessera::core
