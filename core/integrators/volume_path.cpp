// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/volume_path.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "core/integrators/direct_light.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/path.hpp"
#include "core/integrators/path_wavelength.hpp"
#include "core/integrators/path_weights.hpp"
#include "core/integrators/vertex.hpp"
#include "core/media/phase_function.hpp"
#include "core/media/tracking.hpp"

namespace tessera::core::integrators {
namespace {

// Names of the number streams of a path.
constexpr std::uint64_t segment_stream(int depth) {
  return 2 * static_cast<std::uint64_t>(depth);
}
constexpr std::uint64_t shadow_stream(int depth) {
  return 2 * static_cast<std::uint64_t>(depth) + 1;
}

// A scattering point in a medium, with the part of PathVertex's interface that both share.
class MediumVertex {
 public:
  // On a ray of the given time.
  MediumVertex(const Medium& medium, Vec3 position, Vec3 wo, float time)
      : g_(medium.g()), time_(time), position_(position), wo_(wo) {}

  bool is_delta() const { return false; }
  float time() const { return time_; }
  lights::LightSampleContext light_context() const { return {position_, {}}; }
  // The phase function, and the density with which sample() generates `wi`: they are equal.
  BsdfValue evaluate(Vec3 wi) const {
    const float phase = henyey_greenstein(g_, -dot(wo_, wi));
    return {Rgb::gray(phase), phase};
  }
  std::optional<PathVertex::Scattered> sample(Vec2 u, float) const {
    const Vec3 wi = sample_henyey_greenstein(g_, -wo_, u);
    return PathVertex::Scattered{wi, Rgb::gray(1), evaluate(wi).pdf, false, 1};
  }
  Ray ray_along(Vec3 wi) const { return {position_, wi, std::numeric_limits<float>::infinity(), time_}; }
  Ray ray_toward(const lights::LightSample& light) const {
    if (!light.point) return ray_along(light.wi);
    return {position_, offset_origin(*light.point, position_ - light.point->position) - position_, 1, time_};
  }

 private:
  float g_, time_;
  Vec3 position_, wo_;
};

// The medium behind a surface in `direction`, for a ray that is in `current` before. `material` is null for a
// surface without effect.
int medium_beyond(const Material* material, const SurfacePoint& surface, Vec3 direction, int current) {
  if (material == nullptr || !material->media.changes_medium()) return current;
  return dot(surface.geometric_normal, direction) > 0 ? material->media.exterior : material->media.interior;
}

class VolumePath {
 public:
  VolumePath(const RenderPlan& plan, const sampling::Sampler& sampler, RenderCounters& counters,
             LightParts* parts)
      : scene_(plan.scene()),
        settings_(plan.settings()),
        light_sampler_(plan.light_sampler()),
        compensation_(mis_compensation(settings_.integrator)),
        sampler_(sampler),
        counters_(counters),
        parts_(parts),
        hero_(std::min(2, static_cast<int>(3 * sampler.pad(sampling::medium_pad(0))[2]))),
        medium_(scene_.camera_medium()) {}

  Rgb trace(const Ray& ray) {
    ray_ = ray;
    while (step()) ++depth_;
    if (!(settings_.clamp_indirect > 0)) return radiance_;
    const Rgb indirect = clamped(indirect_, settings_.clamp_indirect);
    if (parts_ != nullptr) parts_->indirect = indirect;
    return radiance_ + indirect;
  }

 private:
  // Follows the ray to the next vertex and scatters there; false if the path ends.
  bool step();
  bool collides(float t_max, sampling::NumberStream& numbers, std::optional<float>& t);
  bool shade_surface(const Hit& hit, const Material& material);
  void add_environment();
  void add_emission(const SurfacePoint& surface, const Hit& hit);
  void add_light(Rgb radiance, std::uint32_t light, float pdf, LightParts::Source source);
  template <typename Vertex, typename MediumToward>
  bool scatter(const Vertex& vertex, const MediumToward& medium_toward);
  template <typename Vertex, typename MediumToward>
  void connect_to_light(const Vertex& vertex, const MediumToward& medium_toward);
  SpectralWeights visibility(const Ray& ray, int medium, Enclosure enclosure);
  void attenuate(const Ray& ray, float t_max, int medium, sampling::NumberStream& numbers,
                 SpectralWeights& weights) const;

  // `light` is kNoLight for what a medium emits.
  void add(Rgb radiance, int scatterings, std::uint32_t light,
           LightParts::Source source = LightParts::Source::kEmission) {
    (settings_.clamp_indirect > 0 && scatterings > 1 ? indirect_ : radiance_) += radiance;
    if (parts_ != nullptr) parts_->add(radiance, scatterings, source, scene_.light_group(light));
  }

  const Scene& scene_;
  const RenderSettings& settings_;
  const lights::LightSampler& light_sampler_;
  const lights::MisCompensation compensation_;
  const sampling::Sampler& sampler_;
  RenderCounters& counters_;
  LightParts* const parts_;  // may be null
  const int hero_;           // the channel that samples distances

  Ray ray_;
  int medium_;           // at the ray's origin
  Enclosure enclosure_;  // of the ray's origin
  int depth_ = 0;
  SpectralWeights weights_;
  float eta_scale_ = 1, wavelength_nm_ = 0;  // as PathState
  bool delta_ = true;  // only the ray finds what it hits: as PathState::last_pdf == kDeltaPdf
  lights::LightSampleContext last_{};
  Rgb radiance_{}, indirect_{};
};

// Passes through surfaces by chance, as pass_by_chance() does.
bool VolumePath::step() {
  sampling::NumberStream numbers = sampler_.stream(segment_stream(depth_), sampling::medium_pad(depth_));
  for (std::uint32_t crossing = 0;; ++crossing) {
    ++counters_.closest_hit_rays;
    const Hit hit = scene_.closest_hit(ray_);
    std::optional<float> collision;
    if (!collides(hit.found() ? hit.t : ray_.t_max, numbers, collision)) return false;
    if (collision) {
      // What encloses a collision does not depend on where the path goes on.
      const Enclosing around = enclosure_.along(ray_.direction);
      enclosure_ = {.outside = around, .inside = around};
      const Medium& medium = scene_.media()[static_cast<std::size_t>(medium_)];
      const MediumVertex vertex(medium, ray_.origin + ray_.direction * *collision, normalize(-ray_.direction),
                                ray_.time);
      return scatter(vertex, [this](Vec3) { return medium_; });
    }
    if (!hit.found()) {
      add_environment();
      return false;
    }
    const Crossing met = crossing_at(scene_, origin_at_depth(depth_), ray_, hit, crossing, enclosure_);
    if (met.hit >= 1 ||
        (met.hit > 0 && sampler_.opacity_number(static_cast<std::uint64_t>(depth_), crossing) < met.hit))
      return shade_surface(hit, *met.material);
    if (met.emits) add_emission(met.surface, hit);
    weights_.throughput *= met.tint();
    medium_ = medium_beyond(met.material, met.surface, ray_.direction, medium_);
    ray_ = {offset_origin(met.surface, ray_.direction), ray_.direction, ray_.t_max, ray_.time};
  }
}

// Samples a collision in the ray's medium; false if nothing is left of the path.
bool VolumePath::collides(float t_max, sampling::NumberStream& numbers, std::optional<float>& t) {
  if (medium_ == kNoMedium) return true;
  const Collision collision = sample_collision(scene_.media()[static_cast<std::size_t>(medium_)], ray_, t_max,
                                               hero_, numbers, weights_);
  if (!is_black(collision.emitted)) add(collision.emitted, depth_, lights::kNoLight);
  t = collision.t;
  return max_component(weights_.throughput) > 0;
}

bool VolumePath::shade_surface(const Hit& hit, const Material& material) {
  const PathVertex vertex(scene_, ray_, hit, enclosure_.boundary,
                          wavelength_in(scene_, wavelength_nm_, sampler_, sampling::wavelength_pad(depth_)));
  add_emission(vertex.surface(), hit);
  const auto medium_toward = [&](Vec3 wi) { return medium_beyond(&material, vertex.surface(), wi, medium_); };
  if (!scatter(vertex, medium_toward)) return false;
  wavelength_nm_ = vertex.wavelength_along(ray_.direction);
  return true;
}

void VolumePath::add_environment() {
  if (parts_ != nullptr && depth_ == 0) parts_->escaped = true;
  const std::uint32_t light = scene_.environment_light();
  if (light == lights::kNoLight) return;
  const lights::Environment& environment = scene_.environment();
  if (depth_ == 0 && !environment.visible_to_camera()) return;
  add_light(environment.radiance(ray_.direction), light,
            delta_ ? 0 : environment.pdf(last_.normal, ray_.direction, compensation_),
            LightParts::Source::kEnvironment);
}

// Adds what a surface emits against the ray.
void VolumePath::add_emission(const SurfacePoint& surface, const Hit& hit) {
  const std::uint32_t light = scene_.light_of(hit);
  if (light == lights::kNoLight) return;
  scene_.with_area_light(light, ray_.time, [&](const lights::AreaLight& area) {
    const UvSets uv = uv_sets_at(scene_, hit, surface);
    add_light(area.emitted(scene_.textures(), surface.position, uv, normalize(-ray_.direction)), light,
              delta_ ? 0 : area.pdf(last_.position, surface.position), LightParts::Source::kEmission);
  });
}

// Adds a light's radiance that the ray itself has found. `pdf` is the density with which the last vertex
// samples the ray's direction, given the light.
void VolumePath::add_light(Rgb radiance, std::uint32_t light, float pdf, LightParts::Source source) {
  const float density = mean(weights_.unidirectional);
  float weight = 1;
  if (!delta_ && settings_.integrator == Integrator::kNee) return;
  if (!delta_ && settings_.integrator == Integrator::kMis) {
    const float pmf = light_sampler_.pmf(last_, light, compensation_);
    weight = mis_weight(settings_.heuristic, density, mean(weights_.light) * (pmf * pdf));
  }
  add(weights_.throughput * radiance * (weight / density), depth_, light, source);
}

// Samples a light and a direction to continue in. medium_toward(wi) is the medium in a direction.
template <typename Vertex, typename MediumToward>
bool VolumePath::scatter(const Vertex& vertex, const MediumToward& medium_toward) {
  if (depth_ >= (settings_.max_depth > 0 ? settings_.max_depth : kMaxPathDepth)) return false;
  const float density = mean(weights_.unidirectional);
  weights_ *= Rgb::gray(1 / density);
  if (!light_sampler_.empty() && !vertex.is_delta()) connect_to_light(vertex, medium_toward);
  const auto u = sampler_.pad(sampling::scatter_pad(depth_));
  const auto next = vertex.sample({u[0], u[1]}, u[2]);
  if (!next) return false;
  weights_.throughput *= next->weight;
  eta_scale_ *= next->eta * next->eta;
  if (!survives_roulette(weights_.throughput, eta_scale_, 1.0f, depth_, u[3])) return false;
  delta_ = next->delta;
  weights_.light = delta_ ? weights_.unidirectional : weights_.unidirectional / next->pdf;
  last_ = vertex.light_context();
  medium_ = medium_toward(next->wi);
  ray_ = vertex.ray_along(next->wi);
  return true;
}

template <typename Vertex, typename MediumToward>
void VolumePath::connect_to_light(const Vertex& vertex, const MediumToward& medium_toward) {
  const auto u = sampler_.pad(sampling::light_pad(depth_));
  const lights::LightSampleContext context = vertex.light_context();
  const lights::LightSampler::Choice choice =
      light_sampler_.sample(context, combine_uniforms(u[2], u[3]), compensation_);
  if (choice.light == lights::kNoLight) return;
  const auto light = sample_light(scene_.lights()[choice.light], scene_.textures(), context, {u[0], u[1]},
                                  compensation_, vertex.time());
  if (!light) return;
  const BsdfValue scattered = vertex.evaluate(light->wi);
  if (is_black(scattered.value)) return;
  const SpectralWeights seen = visibility(vertex.ray_toward(*light), medium_toward(light->wi), enclosure_);
  if (is_black(seen.throughput)) return;
  const float by_light = mean(weights_.unidirectional * seen.light) * (light->pdf * choice.pmf);
  const float by_scattering = mean(weights_.unidirectional * seen.unidirectional) * scattered.pdf;
  const float weight = light->delta || settings_.integrator != Integrator::kMis
                           ? 1
                           : mis_weight(settings_.heuristic, by_light, by_scattering);
  add(weights_.throughput * seen.throughput * scattered.value * light->radiance * (weight / by_light),
      depth_ + 1, choice.light);
}

// The weights of a shadow ray that begins in `medium` and at `enclosure`: `throughput` is its transmittance.
SpectralWeights VolumePath::visibility(const Ray& ray, int medium, Enclosure enclosure) {
  sampling::NumberStream numbers =
      sampler_.stream(shadow_stream(depth_), sampling::shadow_medium_pad(depth_));
  SpectralWeights weights;
  if (scene_.is_opaque()) {
    ++counters_.shadow_rays;
    if (scene_.occlusion(ray) != accel::Occlusion::kNone) weights.throughput = {};
    if (!is_black(weights.throughput)) attenuate(ray, ray.t_max, medium, numbers, weights);
    return weights;
  }
  Ray rest = ray;
  for (std::uint32_t crossing = 0;; ++crossing) {
    ++counters_.shadow_rays;
    const Hit hit = scene_.closest_hit(rest);
    Crossing met{};
    if (hit.found()) {
      met = crossing_at(scene_, RayOrigin::kScene, rest, hit, crossing, enclosure);
      weights.throughput *= met.transmittance;
      if (is_black(weights.throughput)) return weights;
    }
    attenuate(rest, hit.found() ? hit.t : rest.t_max, medium, numbers, weights);
    if (!hit.found() || is_black(weights.throughput)) return weights;
    medium = medium_beyond(met.material, met.surface, rest.direction, medium);
    const std::optional<Ray> beyond = rest_of(ray, met.surface);
    if (!beyond) return weights;
    rest = *beyond;
  }
}

void VolumePath::attenuate(const Ray& ray, float t_max, int medium, sampling::NumberStream& numbers,
                           SpectralWeights& weights) const {
  if (medium == kNoMedium) return;
  estimate_transmittance(scene_.media()[static_cast<std::size_t>(medium)], ray, t_max, hero_, numbers,
                         weights);
}

}  // namespace

Rgb trace_volume_path(const RenderPlan& plan, const sampling::Sampler& sampler, const Ray& ray,
                      RenderCounters& counters, LightParts* parts) {
  return VolumePath(plan, sampler, counters, parts).trace(ray);
}

}  // namespace tessera::core::integrators
