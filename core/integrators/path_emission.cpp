// SPDX-License-Identifier: Apache-2.0
// What PathTracer adds of light that a path's own ray finds.
#include "core/integrators/path.hpp"
#include "core/integrators/path_lanes.hpp"
#include "core/integrators/path_weights.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::integrators {

// Adds the environment's radiance to escaped rays.
void PathTracer::add_environment(const Paths& paths, int depth) {
  for (std::size_t lane = 0; depth == 0 && !parts_.empty() && lane < paths.count; ++lane)
    parts_[paths.path[lane]].escaped = true;
  const std::uint32_t light = scene_.environment_light();
  if (light == lights::kNoLight || (depth == 0 && !scene_.environment().visible_to_camera())) return;
  const lights::LightSampleContexts last = paths.states.all(&PathState::last);
  const Vec3Of<FloatN> wi = paths.rays.all(&Ray::direction);
  const lights::Environment::Seen seen = scene_.environment().see(last.normal, wi, compensation_);
  const RgbLanes radiance(seen.radiance);
  const FloatLanes weights(environment_hit_weight(paths, last, wi, seen.pdf));
  for (std::size_t lane = 0; lane < paths.count; ++lane) {
    const RowView<PathState> state = paths.states.at(lane);
    const float weight = is_straight(state) ? straight_weight(state) : weights[lane];
    if (weight > 0)
      add(paths.path[lane], state.get(&PathState::throughput) * radiance[lane] * weight, depth, light,
          LightParts::Source::kEnvironment);
  }
}

// Adds emission hit by the ray itself.
void PathTracer::add_emission(RowView<PathState> state, const EmitterHit& hit, int depth) {
  scene_.with_area_light(hit.light, hit.time, [&](const lights::AreaLight& area) {
    const auto pdf = [&] { return area.pdf(state.get(&PathState::last).position, hit.position); };
    const float weight = depth == 0 && lens_lights_ != nullptr ? camera_ray_weight(state, hit, pdf())
                                                               : emitter_hit_weight(hit.light, state, pdf);
    if (weight > 0)
      add(state.get(&PathState::path),
          state.get(&PathState::throughput) * area.emitted(scene_.textures(), hit.position, hit.uv, hit.wo) *
              weight,
          depth, hit.light);
  });
}

// Adds what a surface emits towards a ray that passes it.
void PathTracer::add_passed_emission(RowView<PathState> state, const Ray& ray, const Hit& hit,
                                     const SurfacePoint& surface, int depth) {
  const std::uint32_t light = scene_.light_of(hit);
  if (light == lights::kNoLight) return;
  add_emission(state,
               {surface.position, scene_.primitives().uv_sets(hit, surface.uv), normalize(-ray.direction),
                light, ray.time},
               depth);
}

// The weight of light that a camera ray found, against connections to the lens.
float PathTracer::camera_ray_weight(RowView<PathState> state, const EmitterHit& hit, float light_pdf) const {
  return lens_lights_->weight(settings_.heuristic, {.focus = state.get(&PathState::last).position,
                                                    .direction = -hit.wo,
                                                    .time = hit.time,
                                                    .light = hit.light,
                                                    .light_pdf = light_pdf});
}

// The weight of light that a BSDF sample found. If the previous vertex could also have sampled it, `nee`
// leaves it to light sampling and `mis` weighs it. `pdf` is the density of the direction, given the light.
template <typename Pdf>
float PathTracer::emitter_hit_weight(std::uint32_t light, RowView<PathState> state, Pdf pdf) const {
  const float last_pdf = state.get(&PathState::last_pdf);
  if (last_pdf == kDeltaPdf || settings_.integrator == Integrator::kNaive) return 1;
  const float scale = state.get(&PathState::emitter_mis_scale);
  if (settings_.integrator == Integrator::kNee || scale == 0) return 0;
  const float light_pdf = light_sample_pdf(state.get(&PathState::last), light, pdf());
  return scale * mis_weight(settings_.heuristic, last_pdf, light_pdf);
}

// The same for the environment, of rays that have escaped in the unit directions `wi`.
FloatN PathTracer::environment_hit_weight(const Paths& paths, const lights::LightSampleContexts& last,
                                          Vec3Of<FloatN> wi, FloatN pdf) const {
  const FloatN last_pdf = paths.states.all(&PathState::last_pdf);
  const MaskN only_bsdf = last_pdf == kDeltaPdf;
  if (settings_.integrator == Integrator::kNaive || all(only_bsdf)) return 1.0f;
  if (settings_.integrator == Integrator::kNee) return select(only_bsdf, FloatN(1.0f), FloatN(0.0f));
  const FloatN scale = paths.states.all(&PathState::emitter_mis_scale);
  const FloatN weight =
      scale * mis_weight(settings_.heuristic, last_pdf, environment_sample_pdf(last, wi, pdf));
  return select(only_bsdf, FloatN(1.0f), select(scale == 0, FloatN(0.0f), weight));
}

// The density with which light samples of the point find an area light in a direction of the density `pdf`,
// given the light.
float PathTracer::light_sample_pdf(const lights::LightSampleContext& from, std::uint32_t light,
                                   float pdf) const {
  const float chosen_pdf = light_sampler_.pmf(from, light, compensation_) * pdf;
  return environment_guide_ == nullptr ? chosen_pdf : (1 - environment_guide_->at(from).share) * chosen_pdf;
}

// The same for the environment in the unit direction `wi`.
template <typename T>
T PathTracer::environment_sample_pdf(const lights::LightSampleContextOf<T>& from, Vec3Of<T> wi, T pdf) const {
  const T chosen_pdf = light_sampler_.environment_pmf(from, compensation_) * pdf;
  if (environment_guide_ == nullptr) return chosen_pdf;
  const auto guidance = environment_guide_->at(from);
  const MaskOf<T> guided = guidance.share > 0;
  if (!any(guided)) return chosen_pdf;
  const T guide_pdf = environment_guide_->sample_or(guidance, false, {}, wi).pdf;
  return select(guided, (1 - guidance.share) * chosen_pdf + guidance.share * guide_pdf, chosen_pdf);
}
template float PathTracer::environment_sample_pdf(const lights::LightSampleContext&, Vec3, float) const;

}  // namespace tessera::core::integrators
