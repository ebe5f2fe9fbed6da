// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/render_plan.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/integrators/panes.hpp"
#include "core/integrators/path_weights.hpp"
#include "core/integrators/volume_path.hpp"
#include "core/integrators/whitted.hpp"

namespace tessera::core::integrators {
namespace {

lights::LightSampler light_sampler_for(const Scene& scene, Integrator integrator, int threads) {
  const auto among = integrator == Integrator::kNaive ? lights::LightSampler::Among::kDelta
                                                      : lights::LightSampler::Among::kAll;
  return lights::LightSampler(scene.lights(), among, threads);
}

// Photons pass through no media.
bool uses_guide(const Scene& scene, Integrator integrator) {
  return (integrator == Integrator::kNee || integrator == Integrator::kMis) && !scene.has_media();
}

// The environment guide's number of paths: as many of the usual ones as there are of photons.
constexpr std::uint32_t camera_paths_beside(std::uint32_t photon_paths) {
  return photon_paths / 16 * 3;
}
static_assert(camera_paths_beside(kPhotonPaths) == kCameraPaths);

// Batches of paths weigh what camera rays hit against it.
bool uses_lens_lights(const Scene& scene, Integrator integrator) {
  return integrator == Integrator::kMis && !scene.has_media();
}

SampleTracer sample_tracer_for(const Scene& scene, Integrator integrator) {
  if (integrator == Integrator::kWhitted) return trace_whitted;
  return scene.has_media() ? trace_volume_path : nullptr;
}

}  // namespace

RenderPlan prepare(const Scene& scene, const RenderSettings& settings, int threads,
                   std::uint32_t photon_paths) {
  auto prepared = std::make_shared<RenderPlan::Prepared>();
  prepared->light_sampler = light_sampler_for(scene, settings.integrator, threads);
  if (uses_guide(scene, settings.integrator)) {
    auto photons = trace_caustic_photons(scene, prepared->light_sampler, threads, photon_paths);
    prepared->samples_through_panes = remove_straight(scene, photons);
    prepared->guide = build_caustic_guide(scene, prepared->light_sampler, photons, threads);
    prepared->environment_guide =
        build_environment_guide(scene, prepared->light_sampler, mis_compensation(settings.integrator),
                                prepared->samples_through_panes, threads, camera_paths_beside(photon_paths));
  }
  if (uses_lens_lights(scene, settings.integrator)) prepared->lens_lights = LensLights(scene, threads);
  prepared->material_bins = material_bins(scene);
  prepared->sample_tracer = sample_tracer_for(scene, settings.integrator);
  return {scene, settings, std::move(prepared)};
}

RenderPlan RenderPlan::with(const RenderSettings& settings) const {
  assert(settings.integrator == settings_.integrator && is_current());
  return {*scene_, settings, prepared_};
}

RenderPlan RenderPlans::get(const RenderSettings& settings, int threads) {
  const MutexLock lock(mutex_);
  std::erase_if(plans_, [](const RenderPlan& plan) { return !plan.is_current(); });
  const auto known = std::find_if(plans_.begin(), plans_.end(), [&](const RenderPlan& plan) {
    return plan.settings().integrator == settings.integrator;
  });
  if (known != plans_.end()) return known->with(settings);
  return plans_.emplace_back(prepare(scene_, settings, threads));
}

}  // namespace tessera::core::integrators
