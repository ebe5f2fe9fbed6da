// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/caustic_guide.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/parallel_errors.hpp"
#include "core/integrators/caustic_casters.hpp"
#include "core/integrators/direct_light.hpp"
#include "core/integrators/guide_building.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/panes.hpp"
#include "core/integrators/path_wavelength.hpp"
#include "core/integrators/vertex.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core::integrators {
namespace {

constexpr int kMaxBounces = 12;
// The number of segments of the paths that estimate other light: more add little accuracy.
constexpr int kProbeDepth = 4;

constexpr std::uint32_t kLightPad = 0;  // light u, v; choice, coarse and fine
constexpr std::uint32_t kPlacePad = 1;  // choice of the caster, coarse and fine; place u, v
constexpr std::uint32_t bounce_pad(int bounce) {
  return 2 + static_cast<std::uint32_t>(bounce);
}  // BSDF u, v, lobe; roulette

// Names the opacity decisions of a ray: 0 for the first ray, then 1 and so on.
constexpr std::uint64_t ray_name(int ray) {
  return static_cast<std::uint64_t>(ray);
}

class PhotonTracer {
 public:
  PhotonTracer(const Scene& scene, const lights::LightSampler& lights, const CausticCasters& casters,
               std::uint32_t paths)
      : scene_(scene),
        lights_(lights),
        casters_(casters),
        paths_(paths),
        beyond_scene_(static_cast<float>(3 * scene.primitives().bounding_radius())) {}

  // Appends the photons that path `index` deposits.
  void trace(std::uint32_t index, std::vector<guiding::Photon>& photons) const {
    const sampling::Sampler sampler(kGuideSeed, 0, kPhotonRow, index);
    const auto first = begin(sampler);
    if (!first) return;
    auto [origin, ray, hit, enclosure, flux, radiance, straight] = *first;
    const Vec3 from_light = ray.direction;
    PanePassage panes;
    float wavelength_nm = 0;
    for (int bounce = 0; bounce < kMaxBounces && hit.found() && luminance(flux) > 0; ++bounce) {
      const PathVertex vertex(
          scene_, ray, hit, enclosure.boundary,
          wavelength_in(scene_, wavelength_nm, sampler, sampling::wavelength_pad(bounce)));
      const float distance = length(vertex.position() - origin);
      if (!casters_.contain(hit) && !vertex.is_delta() && distance > 0)
        photons.push_back({vertex.position(), vertex.side_normal(), vertex.wo(), distance, luminance(flux),
                           luminance(radiance), straight && is_straight(from_light, ray.direction)});
      const auto u = sampler.pad(bounce_pad(bounce));
      const auto [next, choice_weight] = scatter(vertex, {u[0], u[1]}, u[2]);
      if (!next) return;
      const Rgb weight = light_weight(*next);
      const float survival = std::min(1.0f, luminance(flux * weight) / luminance(flux));
      if (u[3] >= survival) return;
      flux *= weight * (choice_weight / survival);
      radiance = casters_.contain(hit) ? radiance * weight : Rgb{};
      straight = straight && pass_pane(vertex, hit, next->wi, panes);
      wavelength_nm = vertex.wavelength_along(next->wi);
      const Ray scattered = vertex.ray_along(next->wi);
      const Met met =
          meet_by_chance(scene_, RayOrigin::kScene, scattered, sampler, ray_name(bounce + 1), enclosure);
      flux *= met.tint;
      radiance *= met.tint;
      origin = scattered.origin;
      ray = met.ray;
      hit = met.hit;
    }
  }

 private:
  // Of light, which refraction does not compress as it does radiance.
  static Rgb light_weight(const PathVertex::Scattered& next) { return next.weight * (next.eta * next.eta); }

  struct Next {
    std::optional<PathVertex::Scattered> way{};  // as paths choose it
    float choice_weight = 1;                     // that flux has for having been chosen otherwise
  };
  // Glass reflects little light, but what arrives by reflection is as bright for the paths that find it. So
  // ways are chosen by the square roots of their shares.
  static Next scatter(const PathVertex& vertex, Vec2 u, float u_lobe) {
    if (!vertex.is_delta()) return {vertex.sample(u, u_lobe)};
    const auto [reflected, refracted, by_coat] = vertex.delta_branches();
    if (!reflected || !refracted || by_coat) return {vertex.sample(u, u_lobe)};
    const float of_reflected = luminance(light_weight(*reflected)),
                of_refracted = luminance(light_weight(*refracted)), all = of_reflected + of_refracted;
    if (!(of_reflected > 0 && of_refracted > 0)) return {vertex.sample(u, u_lobe)};
    const float root = std::sqrt(of_reflected), chance = root / (root + std::sqrt(of_refracted));
    const bool reflects = u_lobe < chance;
    const float share = (reflects ? of_reflected : of_refracted) / all;
    Next next{reflects ? reflected : refracted, share / (reflects ? chance : 1 - chance)};
    next.way->weight *= 1 / share;
    return next;
  }

  // Whether the surface may be that of a pane, and the light still become straight.
  bool pass_pane(const PathVertex& vertex, const Hit& hit, Vec3 wi, PanePassage& panes) const {
    const bool refracted = dot(wi, vertex.side_normal()) < 0,
               inside = dot(vertex.surface().geometric_normal, vertex.wo()) < 0;
    const bool passes =
        vertex.is_delta() && panes.may_continue(refracted, inside) && is_pane_glass(scene_.material_of(hit));
    panes = panes.beyond(refracted);
    return passes;
  }

  struct First {
    Vec3 origin;  // on the light
    Ray ray;      // from the origin, or from the last surface passed through
    Hit hit;      // on the caster
    Enclosure enclosure;
    Rgb flux;
    Rgb radiance;   // Photon::radiance so far
    bool straight;  // whether the light is that of the environment
  };

  // Starts at the caster and samples a light as next-event estimation does, so that all photons reach even
  // a small lens in a large scene.
  std::optional<First> begin(const sampling::Sampler& sampler) const {
    const auto u = sampler.pad(kPlacePad);
    const auto [primitive, instance, position, inverse_density] =
        casters_.sample(combine_uniforms(u[0], u[1]), {u[2], u[3]});
    const auto light = sample_any_light(scene_, lights_, {position, {}}, sampler.pad(kLightPad),
                                        lights::MisCompensation::kOff);
    // Light from delta directions behind mirrors and smooth glass is not found by any path.
    if (!light || light->delta) return std::nullopt;
    const Vec3 origin = light->point ? offset_origin(*light->point, position - light->point->position)
                                     : position + light->wi * beyond_scene_;
    const Ray first{origin, normalize(position - origin), std::numeric_limits<float>::infinity(), kGuideTime};
    Enclosure enclosure;  // as if the light were in the open
    const auto [ray, hit, traced, tint] =
        meet_by_chance(scene_, RayOrigin::kScene, first, sampler, ray_name(0), enclosure);
    if (hit.instance != instance || hit.primitive != primitive) return std::nullopt;
    // The ray may have hit the near side of a sphere whose far side was sampled.
    const SurfacePoint surface = scene_.primitives().surface(ray, hit);
    if (length_squared(surface.position - position) > 1e-4f * length_squared(position - origin))
      return std::nullopt;
    const float cosine = std::fabs(dot(surface.geometric_normal, ray.direction));
    const auto area = static_cast<float>(inverse_density / paths_);
    const Rgb arriving = light->radiance * tint;
    return First{origin,   ray,          hit, enclosure, arriving * (cosine * area / light->pdf),
                 arriving, !light->point};
  }

  const Scene& scene_;
  const lights::LightSampler& lights_;
  const CausticCasters& casters_;
  std::uint32_t paths_;
  float beyond_scene_;
};

// A single-sample estimate of irradiance from indirect light, except paths of only specular scattering;
// found by next-event estimation from the second vertex on.
float probe_other_light(const Scene& scene, const lights::LightSampler& lights, const guiding::Photon& place,
                        std::uint32_t n) {
  const sampling::Sampler sampler(kGuideSeed, 0, kOtherLightRow, n);
  const auto u = sampler.pad(sampling::scatter_pad(0));
  Ray ray{origin_above(place.position, place.side_normal),
          Frame::around(place.side_normal).to_world(sampling::sample_cosine_hemisphere({u[0], u[1]})),
          std::numeric_limits<float>::infinity(), kGuideTime};
  Rgb throughput = Rgb::gray(kPi), found;
  Enclosure enclosure;
  RenderCounters uncounted;
  for (int depth = 1; depth <= kProbeDepth; ++depth) {
    const auto [from, hit, traced, tint] =
        meet_by_chance(scene, RayOrigin::kScene, ray, sampler, ray_name(depth), enclosure);
    if (!hit.found()) break;
    throughput *= tint;
    const PathVertex vertex(scene, from, hit, enclosure.boundary);
    if (!vertex.is_delta())
      if (const auto light =
              sample_any_light(scene, lights, vertex.light_context(), sampler.pad(sampling::light_pad(depth)),
                               lights::MisCompensation::kOff))
        found += throughput * reflected_light(scene, vertex, *light, enclosure, uncounted) / light->pdf;
    const auto v = sampler.pad(sampling::scatter_pad(depth));
    const auto next = vertex.sample({v[0], v[1]}, v[2]);
    if (!next) break;
    throughput *= next->weight;
    ray = vertex.ray_along(next->wi);
  }
  const float value = luminance(found);
  return std::isfinite(value) ? value : 0;
}

}  // namespace

std::vector<guiding::Photon> trace_caustic_photons(const Scene& scene, const lights::LightSampler& lights,
                                                   int threads, std::uint32_t photon_paths) {
  assert(photon_paths % kPhotonPathsAtOnce == 0);
  const CausticCasters casters(scene);
  if (casters.empty() || lights.empty()) return {};
  const PhotonTracer tracer(scene, lights, casters, photon_paths);
  std::vector<std::vector<guiding::Photon>> parts(photon_paths / kPhotonPathsAtOnce);
  ParallelErrors errors;
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (std::uint32_t part = 0; part < parts.size(); ++part) {
    errors.run([&] {
      for (std::uint32_t i = 0; i < kPhotonPathsAtOnce; ++i)
        tracer.trace(part * kPhotonPathsAtOnce + i, parts[part]);
    });
  }
  errors.rethrow();
  std::vector<guiding::Photon> photons;
  for (const auto& part : parts)
    std::copy_if(part.begin(), part.end(), std::back_inserter(photons), [](const guiding::Photon& photon) {
      return photon.flux > 0 && std::isfinite(photon.flux) && std::isfinite(photon.radiance);
    });
  return photons;
}

guiding::LightGuide build_caustic_guide(const Scene& scene, const lights::LightSampler& lights,
                                        std::span<const guiding::Photon> photons, int threads) {
  const auto other_light = [&](const guiding::Photon& place, std::uint32_t n) {
    return probe_other_light(scene, lights, place, n);
  };
  return guiding::LightGuide::build(photons, guiding::share_beside(other_light), threads);
}

}  // namespace tessera::core::integrators
