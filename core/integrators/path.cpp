#include "core/integrators/path.hpp"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include "core/integrators/direct_light.hpp"

namespace tessera::core {
namespace {

constexpr int kFirstRouletteDepth = 3;
constexpr float kMaxSurvival = 0.95f;  // below 1, so that a path between perfect mirrors ends

// For one sample of each strategy (Veach and Guibas 1995). Densities may be so large that their squares are
// not finite, but their ratio's is.
float mis_weight(Heuristic heuristic, float pdf, float other_pdf) {
  if (heuristic == Heuristic::kBalance) return pdf / (pdf + other_pdf);
  const float ratio = other_pdf / pdf;
  return 1 / (1 + ratio * ratio);
}

// Russian roulette (Arvo and Kirk 1990), by the throughput without the compression of radiance by refraction,
// which the way out of the glass undoes, and without what the guide's densities divided it by: there is more
// light where they are higher (Vorba and Křivánek 2016).
bool survives_roulette(PathHead& head, int depth, float u) {
  const float contribution = max_component(head.throughput) * head.eta_scale * head.promise;
  if (!(contribution > 0)) return false;
  if (depth < kFirstRouletteDepth) return true;
  const float survival = std::min(kMaxSurvival, contribution);
  if (u >= survival) return false;
  head.throughput *= 1 / survival;
  return true;
}

}  // namespace

PathTracer::PathTracer(const Scene& scene, const RenderSettings& settings, const LightGuide* guide)
    : scene_(scene),
      settings_(settings),
      // By chance alone, `naive` finds every other light.
      light_sampler_(settings.integrator == Integrator::kNaive ? scene.delta_light_sampler()
                                                               : scene.light_sampler()),
      guide_(guide) {}

void PathTracer::trace(std::span<const Ray> rays, std::span<const Sampler> samplers, std::span<Rgb> radiance,
                       RenderCounters& counters) {
  assert(rays.size() <= kBatchPaths && rays.size() == samplers.size() && rays.size() == radiance.size());
  samplers_ = samplers;
  radiance_ = radiance;
  std::fill(radiance.begin(), radiance.end(), Rgb{});
  paths_->clear();
  for (std::uint32_t path = 0; path < rays.size(); ++path) paths_->push(rays[path], {.path = path});
  for (int depth = 0; !paths_->empty(); ++depth) step(depth, counters);
}

// Takes every path from one vertex to the next.
void PathTracer::step(int depth, RenderCounters& counters) {
  const std::span<const Ray> rays = paths_->rays();
  counters.closest_hit_rays += rays.size();
  scene_.bvh().closest_hits(scene_.primitives(), rays, {hits_.data(), rays.size()});

  next_paths_->clear();
  for (std::size_t slot = 0; slot < rays.size(); ++slot) {
    const PathHead& head = paths_->head(slot);
    const Hit& hit = hits_[slot];
    if (!hit.found()) {
      add_environment(head, rays[slot].direction);
      continue;
    }
    const PathVertex vertex(scene_, rays[slot], hit);
    add_emission(head, vertex, scene_.light_of(hit));
    if (settings_.max_depth > 0 && depth >= settings_.max_depth) continue;
    const Cell* cell = guide_at(vertex);
    if (!vertex.is_delta()) connect_to_light(head, vertex, cell, depth);
    scatter(head, vertex, cell, depth);
  }
  add_unoccluded(counters);
  std::swap(paths_, next_paths_);
}

// What a ray sees that meets nothing.
void PathTracer::add_environment(const PathHead& head, Vec3 direction) {
  const std::uint32_t light = scene_.environment_light();
  if (light == kNoLight) return;
  const float weight = weight_of_found(light, head, [&] { return scene_.environment().pdf(direction); });
  if (weight > 0) radiance_[head.path] += head.throughput * scene_.environment().radiance(direction) * weight;
}

// Emission met by the ray itself.
void PathTracer::add_emission(const PathHead& head, const PathVertex& vertex, std::uint32_t light) {
  if (light == kNoLight) return;
  const AreaLight& area = scene_.area_light(light);
  const float weight =
      weight_of_found(light, head, [&] { return area.pdf(head.last.position, vertex.position()); });
  if (weight > 0)
    radiance_[head.path] +=
        head.throughput * area.emitted(scene_.textures(), vertex.surface(), vertex.wo()) * weight;
}

// What is known there of caustics; null where nothing is, or no choice.
const LightGuide::Cell* PathTracer::guide_at(const PathVertex& vertex) const {
  return guide_ && !vertex.is_delta() ? guide_->find(vertex.position(), vertex.side_normal()) : nullptr;
}

// Of light that a BSDF sample found. Where the vertex before could also have sampled it, `nee` leaves it to
// that and `mis` weighs it. `pdf`: of sampling the direction, once the light is chosen.
template <typename Pdf>
float PathTracer::weight_of_found(std::uint32_t light, const PathHead& head, Pdf pdf) const {
  if (head.last_pdf == kDeltaPdf || settings_.integrator == Integrator::kNaive) return 1;
  if (settings_.integrator == Integrator::kNee || head.met_scale == 0) return 0;
  return head.met_scale *
         mis_weight(settings_.heuristic, head.last_pdf, scene_.light_sampler().pmf(head.last, light) * pdf());
}

// Samples a light and what the vertex reflects of it towards the path's beginning.
void PathTracer::connect_to_light(const PathHead& head, const PathVertex& vertex, const Cell* cell,
                                  int depth) {
  if (light_sampler_.empty()) return;
  const auto u = samplers_[head.path].pad(light_pad(depth));
  const auto choice = light_sampler_.sample(vertex.lit_point(), two_digits(u[2], u[3]));
  if (choice.light == kNoLight) return;
  const auto light =
      sample_light(scene_.lights()[choice.light], scene_.textures(), vertex.position(), {u[0], u[1]});
  if (!light) return;
  const BsdfValue scattered = vertex.evaluate(light->wi);
  if (is_black(scattered.value)) return;
  const float light_pdf = choice.pmf * light->pdf;
  // Nothing else finds delta lights.
  const bool weighed = settings_.integrator == Integrator::kMis && !light->delta;
  const float bsdf_pdf = scattered.pdf * (cell ? 1 - cell->share : 1);
  const float weight = weighed ? mis_weight(settings_.heuristic, light_pdf, bsdf_pdf) : 1;
  shadow_rays_[connection_count_] = vertex.ray_toward(*light);
  connections_[connection_count_] = {
      head.path, head.throughput * (scattered.value * light->radiance) * (weight / light_pdf)};
  ++connection_count_;
}

// Sends the path on, where it does not end.
void PathTracer::scatter(PathHead head, const PathVertex& vertex, const Cell* cell, int depth) {
  const auto u = samplers_[head.path].pad(scatter_pad(depth));
  head.met_scale = 1;
  const auto next =
      cell ? choose_direction(head, vertex, *cell, {u[0], u[1]}, u[2]) : vertex.sample({u[0], u[1]}, u[2]);
  if (!next) return;
  head.throughput *= next->weight;
  head.eta_scale *= next->eta * next->eta;
  if (!survives_roulette(head, depth, u[3])) return;
  head.last_pdf = next->delta ? kDeltaPdf : next->pdf;
  head.last = vertex.lit_point();
  next_paths_->push(vertex.ray_along(next->wi), head);
}

// By the guide or by the BSDF: one sample of a mixture (Veach and Guibas 1995, section 3.3). The guide knows
// nothing of light that comes straight from its source. So whatever the next ray itself meets is left to the
// BSDF's samples and the lights', which then need not ask for the guide's densities; `pdf` is the BSDF's
// share.
std::optional<PathVertex::Scattered> PathTracer::choose_direction(PathHead& head, const PathVertex& vertex,
                                                                  const Cell& cell, Vec2 u,
                                                                  float u_lobe) const {
  constexpr float kBelowOne = 1 - 0x1p-24f;
  const bool guided = u.x < cell.share;
  u.x = std::min(guided ? u.x / cell.share : (u.x - cell.share) / (1 - cell.share), kBelowOne);
  PathVertex::Scattered next{};
  if (guided) {
    next.wi = guide_->sample(cell, vertex.position(), u);
    const auto [value, pdf] = vertex.evaluate(next.wi);
    if (is_black(value)) return std::nullopt;
    next.weight = value;  // to be divided by the mixture's density
    next.pdf = pdf;
    next.eta = 1;
  } else {
    const auto sampled = vertex.sample(u, u_lobe);
    if (!sampled) return std::nullopt;
    next = *sampled;
    next.weight *= next.pdf;
  }
  const float by_bsdf = (1 - cell.share) * next.pdf;
  const float mixed = cell.share * guide_->pdf(cell, vertex.position(), next.wi) + by_bsdf;
  next.weight *= 1 / mixed;
  head.met_scale = guided ? 0 : mixed / by_bsdf;
  head.promise *= mixed / next.pdf;
  next.pdf = by_bsdf;
  return next;
}

void PathTracer::add_unoccluded(RenderCounters& counters) {
  const std::size_t count = std::exchange(connection_count_, 0);
  counters.shadow_rays += count;
  scene_.bvh().any_hits(scene_.primitives(), {shadow_rays_.data(), count}, {occluded_.data(), count});
  for (std::size_t i = 0; i < count; ++i)
    if (occluded_[i] == 0) radiance_[connections_[i].path] += connections_[i].radiance;
}

}  // namespace tessera::core
