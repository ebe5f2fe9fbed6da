// SPDX-License-Identifier: Apache-2.0
// Path tracing (Kajiya 1986), many paths at a time: samples of the radiance that arrives along camera rays.
// Hundreds of paths advance together (Laine, Karras and Aila 2013), so that rays are traced and surfaces
// shaded in large coherent batches. All paths of a batch are at the same depth, or all are deep; paths that
// reach a depth wait until there are enough. A path's result does not depend on the other paths.
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/film/film.hpp"
#include "core/integrators/light_parts.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/path_state.hpp"
#include "core/integrators/render_plan.hpp"
#include "core/integrators/shading_bins.hpp"
#include "core/integrators/vertex_batch.hpp"
#include "core/math/columns.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

// The maximum depth of a path, needed between perfect mirrors, where Russian roulette ends no path.
inline constexpr int kMaxPathDepth = 4096;

// Unbiased with every strategy, except for settings.max_depth, settings.clamp_indirect and kMaxPathDepth.
// Too large for the stack. For use by one thread.
class PathTracer {
 public:
  // Path i uses the random numbers of samplers[i], and its result is added to radiance[i], and divided to
  // parts[i] if there are any. Keeps references.
  PathTracer(const RenderPlan& plan, std::span<const sampling::Sampler> samplers, std::span<Rgb> radiance,
             std::span<LightParts> parts = {});

  // Starts path paths[i], which must not be active, with the camera ray in lane i, for up to kLaneCount of
  // them. `focuses` are where the camera has the rays in focus, if the plan has lens lights.
  void begin(const RayOf<FloatN>& rays, std::span<const std::uint32_t> paths,
             const Vec3Of<FloatN>& focuses = {});
  // Adds light that arrives at the lens to a path that has begun, unless something is in the way. For up to
  // kBatchPaths connections, which are traced together by add_connections(), before the next step.
  void connect(std::uint32_t path, const LensLights::Connection& connection) {
    connections_.push({connection.ray, path, connection.radiance, connection.light});
  }
  void add_connections(RenderCounters& counters) { add_unoccluded(counters, kAtLens); }

  // Advances up to kBatchPaths paths by one step, at the depth where most paths wait. Some path must be
  // active. Returns the paths that have ended, valid until the next step. Rays are counted in `counters`.
  std::span<const std::uint32_t> step(RenderCounters& counters);

 private:
  // Unoccluded light for a vertex, to be added if the shadow ray hits nothing.
  struct Connection {
    Ray ray;
    std::uint32_t path;
    Rgb radiance;  // to be added to the path
    std::uint32_t light;
  };

  struct Paths;  // up to kLaneCount paths

  Enclosure& enclosure(std::uint32_t path) {
    return enclosures_[scene_.nested_dielectrics().empty() ? 0 : path];
  }
  void pass_through_surfaces(RenderCounters& counters, int depth);
  static constexpr std::size_t kListsByDepth = 64;  // even
  static std::size_t list_after(std::size_t list);
  std::size_t longest_list() const;
  void collect_ended();
  void add_indirect(std::uint32_t path);
  template <typename Vertices>
  void shade(const Paths& paths, const Vertices& vertices, int depth);
  void shade(Kernel kernel, const Paths& paths, int depth);
  void find_wavelengths(Paths& paths, int depth) const;
  std::array<FloatN, 4> numbers(const Paths& paths, int depth, std::uint32_t (*pad_at)(int)) const;
  void add_environment(const Paths& paths, int depth);
  // A point of an area light that a ray has hit.
  struct EmitterHit {
    Vec3 position;
    UvSets uv;
    Vec3 wo;
    std::uint32_t light;
    float time;
  };
  void add_emission(RowView<PathState> state, const EmitterHit& hit, int depth);
  void add_passed_emission(RowView<PathState> state, const Ray& ray, const Hit& hit,
                           const SurfacePoint& surface, int depth);
  void put_times(const Paths& paths, const NewRows<Ray>& rays) const;
  // How paths are scattered at their vertices.
  struct Scattering {
    lights::LightSampleContexts context;
    Vec3Of<FloatN> wi;
    FloatN bsdf_pdf, emitter_mis_scale;
    MaskN delta, refracted, inside;  // inside: they arrive at the back of the surface
  };
  void put_straight(const Paths& paths, const Scattering& at, const NewRows<PathState>& states,
                    int depth) const;
  // Whether light samples of vertices at this depth pass panes.
  bool passes_panes_at(int depth) const {
    return through_panes_ && depth != kAtLens && depth < static_cast<int>(kListsByDepth);
  }
  bool is_straight(RowView<PathState> state) const;
  float straight_weight(RowView<PathState> state) const;
  void add_straight(RenderCounters& counters, int depth);
  float camera_ray_weight(RowView<PathState> state, const EmitterHit& hit, float light_pdf) const;
  template <typename Pdf>
  float emitter_hit_weight(std::uint32_t light, RowView<PathState> state, Pdf pdf) const;
  FloatN environment_hit_weight(const Paths& paths, const lights::LightSampleContexts& last,
                                Vec3Of<FloatN> wi, FloatN pdf) const;
  float light_sample_pdf(const lights::LightSampleContext& from, std::uint32_t light, float pdf) const;
  template <typename T>
  T environment_sample_pdf(const lights::LightSampleContextOf<T>& from, Vec3Of<T> wi, T pdf) const;
  using Guidance = guiding::LightGuide::GuidanceOf<FloatN>;
  template <typename Vertices>
  Guidance guidance_at(const Vertices& vertices) const;
  template <typename Vertices>
  void connect_to_lights(const Paths& paths, const Vertices& vertices, FloatN guide_share, unsigned lit,
                         int depth);
  // Light samples of vertices, and their densities.
  struct LightConnections {
    lights::LightSamples lights;
    U32xN chosen;  // the light of each lane
    FloatN pdf;    // per solid angle, with that of the choice
  };
  LightConnections sample_lights(const Paths& paths, const lights::LightSampleContexts& from, unsigned lit,
                                 int depth) const;
  LightConnections sample_chosen_lights(const Paths& paths, const lights::LightSampleContexts& from,
                                        Vec2Of<FloatN> u, DoubleN u_light, unsigned lit) const;
  void guide_to_environment(const lights::LightSampleContexts& from,
                            const EnvironmentGuide::GuidanceOf<FloatN>& guidance, MaskN guided,
                            Vec2Of<FloatN> u, LightConnections& connections) const;
  FloatN light_sample_weight(FloatN light_pdf, MaskN delta, FloatN bsdf_pdf) const;
  template <typename Vertices>
  void scatter(const Paths& paths, const Vertices& vertices, const Guidance& guidance, int depth);
  struct Directions;  // continuation directions of paths
  template <typename Vertices>
  Directions choose_directions(const Vertices& vertices, const Guidance& guidance, Vec2Of<FloatN> u,
                               FloatN u_lobe) const;
  // The depth of the lens, where light arrives that was never scattered.
  static constexpr int kAtLens = -1;
  void add_unoccluded(RenderCounters& counters, int depth);
  void add_transmitted(RenderCounters& counters, int depth);
  // Adds light of the light of this index that was scattered this many times.
  void add(std::uint32_t path, Rgb radiance, int scatterings, std::uint32_t light,
           LightParts::Source source = LightParts::Source::kEmission) {
    (clamps_ && scatterings > 1 ? indirect_[path] : radiance_[path]) += radiance;
    if (!parts_.empty()) parts_[path].add(radiance, scatterings, source, scene_.light_group(light));
  }

  const Scene& scene_;
  const RenderSettings settings_;
  const lights::LightSampler& light_sampler_;
  const lights::MisCompensation compensation_;
  const guiding::LightGuide* const guide_;           // null if there is none
  const EnvironmentGuide* const environment_guide_;  // null if there is none
  const bool through_panes_;                         // RenderPlan::samples_through_panes()
  const LensLights* const lens_lights_;              // null if there are none

  const std::span<const sampling::Sampler> samplers_;
  const std::span<Rgb> radiance_;
  const std::span<LightParts> parts_;  // empty, or one for each path
  // Waiting paths by depth; never empty. Two more lists, for even and odd depths, hold paths with a depth
  // of at least kListsByDepth.
  std::deque<Columns<PathState>> waiting_{1};
  std::vector<std::uint16_t> depths_;  // depth of each path
  const bool clamps_;                  // settings_.clamp_indirect
  std::vector<Rgb> indirect_;          // by path, if it clamps: indirect light
  // By path: where it is among nested dielectrics. A single one where there are none.
  std::vector<Enclosure> enclosures_;
  std::vector<std::uint8_t> survives_;  // by path: whether it survives this step
  std::vector<std::uint32_t> ended_;
  // State of a step:
  ColumnsView<PathState> batch_;
  Columns<PathState>* next_paths_ = nullptr;
  Columns<Hit> hits_{kBatchPaths};                       // of the batch's rays
  std::array<const Material*, kBatchPaths> boundaries_;  // Enclosure::boundary of hits_, if any are nested
  ShadingBins bins_;
  Columns<Connection> connections_;
  std::array<accel::Occlusion, kBatchPaths> occluded_;  // of connections_
};

}  // namespace tessera::core::integrators
