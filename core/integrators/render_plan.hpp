// SPDX-License-Identifier: Apache-2.0
// What rendering needs besides the scene: everything that is computed once for a scene and settings, so that
// calls of render() only trace rays. A plan is immutable, shared by all threads, and cheap to copy.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/mutex.hpp"
#include "core/film/film.hpp"
#include "core/guiding/light_guide.hpp"
#include "core/integrators/caustic_guide.hpp"
#include "core/integrators/environment_guide.hpp"
#include "core/integrators/lens_lights.hpp"
#include "core/integrators/light_parts.hpp"
#include "core/integrators/shading_bins.hpp"
#include "core/lights/light_sampler.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/settings.hpp"

namespace tessera::core::integrators {

class RenderPlan;

// Traces the camera ray of one sample and returns its radiance. Counts rays, and adds the light's parts to
// `parts` if that is not null.
using SampleTracer = Rgb (*)(const RenderPlan& plan, const sampling::Sampler& sampler, const Ray& ray,
                             RenderCounters& counters, LightParts* parts);

class RenderPlan {
 public:
  const Scene& scene() const { return *scene_; }
  const RenderSettings& settings() const { return settings_; }
  // Whether the scene still shows what the plan was made for.
  bool is_current() const { return scene_->revision() == revision_; }

  // Samples the lights that the integrator connects to: `naive` only those that rays cannot hit.
  const lights::LightSampler& light_sampler() const { return prepared_->light_sampler; }
  // Where caustics come from; null if the integrator uses no guide or there are none.
  const guiding::LightGuide* guide() const {
    return prepared_->guide.cells().empty() ? nullptr : &prepared_->guide;
  }
  // Where the environment is seen through openings; null if the integrator uses no guide or there are none.
  const EnvironmentGuide* environment_guide() const {
    return prepared_->environment_guide.empty() ? nullptr : &prepared_->environment_guide;
  }
  // Whether light samples of the environment pass panes (panes.hpp).
  bool samples_through_panes() const { return prepared_->samples_through_panes; }
  // The lamps that the lens connects to; null if the integrator or the camera does not, or there are none.
  const LensLights* lens_lights() const {
    return prepared_->lens_lights.empty() ? nullptr : &prepared_->lens_lights;
  }
  const MaterialBins& material_bins() const { return prepared_->material_bins; }
  // Null if the integrator traces batches of paths (path.hpp).
  SampleTracer sample_tracer() const { return prepared_->sample_tracer; }

  // The plan for other settings with the same integrator: all else is independent of settings, and shared.
  RenderPlan with(const RenderSettings& settings) const;

 private:
  friend RenderPlan prepare(const Scene& scene, const RenderSettings& settings, int threads,
                            std::uint32_t photon_paths);
  struct Prepared {
    lights::LightSampler light_sampler;
    guiding::LightGuide guide;
    EnvironmentGuide environment_guide;
    bool samples_through_panes = false;
    LensLights lens_lights;
    MaterialBins material_bins;
    SampleTracer sample_tracer = nullptr;
  };
  RenderPlan(const Scene& scene, const RenderSettings& settings, std::shared_ptr<const Prepared> prepared)
      : scene_(&scene), revision_(scene.revision()), settings_(settings), prepared_(std::move(prepared)) {}

  const Scene* scene_;
  std::uint64_t revision_;
  RenderSettings settings_;
  std::shared_ptr<const Prepared> prepared_;
};

// Takes some tenths of a second where there are caustics, and where openings let in the environment's light.
// The result does not depend on `threads`. It refers to the scene, and is of use until that shows another
// frame (RenderPlan::is_current). Other numbers of photon paths, multiples of kPhotonPathsAtOnce, make other
// images of the same expectation: fewer take less time, and make more noise.
RenderPlan prepare(const Scene& scene, const RenderSettings& settings, int threads,
                   std::uint32_t photon_paths = kPhotonPaths);

// Makes the plans of a scene for various settings, and prepares once for each integrator. Thread-safe while
// the scene does not change.
class RenderPlans {
 public:
  // Keeps a reference.
  explicit RenderPlans(const Scene& scene) : scene_(scene) {}

  const Scene& scene() const { return scene_; }
  // As prepare(); while one thread prepares, others wait.
  RenderPlan get(const RenderSettings& settings, int threads);

 private:
  const Scene& scene_;
  Mutex mutex_;
  std::vector<RenderPlan> plans_ TESSERA_GUARDED_BY(mutex_);  // one for each integrator
};

}  // namespace tessera::core::integrators
