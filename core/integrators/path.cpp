#include "core/integrators/path.hpp"

#include <algorithm>
#include <optional>

#include "core/integrators/direct_light.hpp"
#include "core/integrators/vertex.hpp"

namespace tessera::core {
namespace {

// For one sample of each strategy (Veach and Guibas 1995). Densities may be so large that their squares are
// not finite, but their ratio's is.
float mis_weight(Heuristic heuristic, float pdf, float other_pdf) {
  if (heuristic == Heuristic::kBalance) return pdf / (pdf + other_pdf);
  const float ratio = other_pdf / pdf;
  return 1 / (1 + ratio * ratio);
}

// Follows one path from the camera. `throughput_` is the product of the BSDF weights so far: what radiance
// found at the path's end is multiplied by.
class PathTracer {
 public:
  PathTracer(const Scene& scene, const RenderSettings& settings, const Sampler& sampler,
             RenderCounters& counters)
      : scene_(scene),
        settings_(settings),
        sampler_(sampler),
        counters_(counters),
        // By chance alone, `naive` finds every other light.
        light_sampler_(settings.integrator == Integrator::kNaive ? scene.delta_light_sampler()
                                                                 : scene.light_sampler()) {}

  Rgb trace(Ray ray) {
    for (int depth = 0;; ++depth) {
      ++counters_.closest_hit_rays;
      const Hit hit = scene_.bvh().closest_hit(scene_.primitives(), ray);
      if (!hit.found()) {
        add_environment(ray.direction);
        break;
      }
      const PathVertex vertex(scene_, ray, hit);
      add_emission(vertex, scene_.light_of(hit.primitive));
      if (settings_.max_depth > 0 && depth >= settings_.max_depth) break;
      if (!vertex.is_delta()) add_direct_light(vertex, depth);
      const auto next = scatter(vertex, depth);
      if (!next) break;
      ray = *next;
    }
    return radiance_;
  }

 private:
  // Emission met by the ray itself.
  void add_emission(const PathVertex& vertex, std::uint32_t light_id) {
    if (light_id == kNoLight) return;
    const AreaLight& light = scene_.area_light(light_id);
    const float weight =
        weight_of_found(light_id, [&] { return light.pdf(last_position_, vertex.position()); });
    if (weight > 0)
      radiance_ += throughput_ * light.emitted(scene_.textures(), vertex.surface(), vertex.wo()) * weight;
  }

  // What a ray sees that meets nothing.
  void add_environment(Vec3 direction) {
    const std::uint32_t light_id = scene_.environment_light();
    if (light_id == kNoLight) return;
    const float weight = weight_of_found(light_id, [&] { return scene_.environment().pdf(direction); });
    if (weight > 0) radiance_ += throughput_ * scene_.environment().radiance(direction) * weight;
  }

  // Of light that a BSDF sample found. Where the vertex before could also have sampled it, `nee` leaves it to
  // that and `mis` weighs it. `pdf`: of sampling the direction, once the light is chosen.
  template <typename Pdf>
  float weight_of_found(std::uint32_t light_id, Pdf pdf) const {
    if (last_was_delta_ || settings_.integrator == Integrator::kNaive) return 1;
    if (settings_.integrator == Integrator::kNee) return 0;
    return mis_weight(settings_.heuristic, last_pdf_, scene_.light_sampler().pmf(light_id) * pdf());
  }

  void add_direct_light(const PathVertex& vertex, int depth) {
    if (light_sampler_.empty()) return;
    const auto u = sampler_.pad(light_pad(depth));
    const auto choice = light_sampler_.sample(two_digits(u[2], u[3]));
    const auto light =
        sample_light(scene_.lights()[choice.light], scene_.textures(), vertex.position(), {u[0], u[1]});
    if (!light) return;
    const Rgb reflected = reflected_light(scene_, vertex, *light, counters_);
    if (is_black(reflected)) return;
    const float light_pdf = choice.pmf * light->pdf;
    // Nothing else finds delta lights.
    const bool weighed = settings_.integrator == Integrator::kMis && !light->delta;
    const float weight = weighed ? mis_weight(settings_.heuristic, light_pdf, vertex.pdf(light->wi)) : 1;
    radiance_ += throughput_ * reflected * (weight / light_pdf);
  }

  // The next ray of the path; nothing where it ends.
  std::optional<Ray> scatter(const PathVertex& vertex, int depth) {
    const auto u = sampler_.pad(scatter_pad(depth));
    const auto next = vertex.sample({u[0], u[1]}, u[2]);
    if (!next) return std::nullopt;
    throughput_ *= next->weight;
    eta_scale_ *= next->eta * next->eta;
    if (!survives_roulette(depth, u[3])) return std::nullopt;
    last_was_delta_ = next->delta;
    last_pdf_ = next->pdf;
    last_position_ = vertex.position();
    return vertex.ray_along(next->wi);
  }

  // Russian roulette (Arvo and Kirk 1990), by the throughput without the compression of radiance by
  // refraction, which the way out of the glass undoes.
  bool survives_roulette(int depth, float u) {
    const float contribution = max_component(throughput_) * eta_scale_;
    if (!(contribution > 0)) return false;
    if (depth < kFirstRouletteDepth) return true;
    const float survival = std::min(kMaxSurvival, contribution);
    if (u >= survival) return false;
    throughput_ *= 1 / survival;
    return true;
  }

  static constexpr int kFirstRouletteDepth = 3;
  static constexpr float kMaxSurvival = 0.95f;  // below 1, so that a path between perfect mirrors ends

  const Scene& scene_;
  const RenderSettings& settings_;
  const Sampler& sampler_;
  RenderCounters& counters_;
  const LightSampler& light_sampler_;

  Rgb radiance_{};
  Rgb throughput_ = Rgb::gray(1);
  float eta_scale_ = 1;
  bool last_was_delta_ = true;  // the camera's ray finds lights that nothing else could
  float last_pdf_ = 0;
  Vec3 last_position_{};
};

}  // namespace

Rgb trace_path(const Scene& scene, const RenderSettings& settings, const Sampler& sampler, Ray ray,
               RenderCounters& counters) {
  return PathTracer(scene, settings, sampler, counters).trace(ray);
}

}  // namespace tessera::core
