#include "core/integrators/path.hpp"

#include <algorithm>
#include <optional>

#include "core/integrators/vertex.hpp"

namespace tessera::core {
namespace {

// Balance heuristic for one sample of each strategy (Veach and Guibas 1995).
float mis_weight(float pdf, float other_pdf) {
  return pdf / (pdf + other_pdf);
}

// One number in [0, 1) of 48 bits from two of 24, so that lights of little power among great ones can be
// chosen.
double two_digits(float coarse, float fine) {
  return static_cast<double>(coarse) + static_cast<double>(fine) * 0x1p-24;
}

// Follows one path from the camera. `throughput_` is the product of the BSDF weights so far: what radiance
// found at the path's end is multiplied by.
class PathTracer {
 public:
  PathTracer(const Scene& scene, const RenderSettings& settings, const Sampler& sampler,
             RenderCounters& counters)
      : scene_(scene), settings_(settings), sampler_(sampler), counters_(counters) {}

  Rgb trace(Ray ray) {
    for (int depth = 0;; ++depth) {
      ++counters_.closest_hit_rays;
      const Hit hit = scene_.bvh().closest_hit(scene_.primitives(), ray);
      if (!hit.found()) break;
      const PathVertex vertex(scene_, ray, hit);
      add_emission(vertex, scene_.light_of(hit.primitive));
      if (settings_.max_depth > 0 && depth >= settings_.max_depth) break;
      if (settings_.integrator != Integrator::kNaive && !vertex.is_delta()) add_direct_light(vertex, depth);
      const auto next = scatter(vertex, depth);
      if (!next) break;
      ray = *next;
    }
    return radiance_;
  }

 private:
  // Emission met by the ray itself. Where the vertex before could also have sampled the light, `nee` leaves
  // it to that and `mis` weighs it.
  void add_emission(const PathVertex& vertex, std::uint32_t light_id) {
    if (light_id == kNoLight) return;
    const Light& light = scene_.lights()[light_id];
    const Rgb emitted = light.emitted(vertex.position(), vertex.wo());
    float weight = 1;
    if (!last_was_delta_ && settings_.integrator == Integrator::kNee) return;
    if (!last_was_delta_ && settings_.integrator == Integrator::kMis) {
      const float light_pdf =
          scene_.light_sampler().pmf(light_id) * light.pdf(last_position_, vertex.position());
      weight = mis_weight(last_pdf_, light_pdf);
    }
    radiance_ += throughput_ * emitted * weight;
  }

  void add_direct_light(const PathVertex& vertex, int depth) {
    const auto u = sampler_.pad(light_pad(depth));
    const auto choice = scene_.light_sampler().sample(two_digits(u[2], u[3]));
    if (!choice) return;
    const auto light = scene_.lights()[choice->light].sample(vertex.position(), {u[0], u[1]});
    if (!light) return;
    const Rgb scattered = vertex.evaluate(light->wi);
    if (is_black(scattered)) return;
    ++counters_.shadow_rays;
    if (scene_.bvh().any_hit(scene_.primitives(), vertex.ray_to(light->point))) return;
    const float light_pdf = choice->pmf * light->pdf;
    const float weight =
        settings_.integrator == Integrator::kMis ? mis_weight(light_pdf, vertex.pdf(light->wi)) : 1;
    radiance_ += throughput_ * scattered * light->radiance * (weight / light_pdf);
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
