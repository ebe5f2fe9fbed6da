// SPDX-License-Identifier: Apache-2.0
// Rays and surfaces that let light pass straight through: by their opacity, as panes do (interception_at), or
// because they lie in a nested dielectric of higher priority (nested_dielectrics.hpp).
// A scattering ray hits such a surface with a probability, and otherwise goes on behind it, tinted; a shadow
// ray is attenuated by the transmittance. The expectation of the former equals the latter. Stateless;
// thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

// The maximum number of surfaces that a ray crosses. The next one is treated as opaque, so that every ray
// ends.
inline constexpr std::uint32_t kMaxCrossings = 1u << 14;

// Where a ray begins. Camera rays pass what is hidden from the camera.
enum class RayOrigin { kCamera, kScene };
inline RayOrigin origin_at_depth(int depth) {
  return depth == 0 ? RayOrigin::kCamera : RayOrigin::kScene;
}

// A place of a path among nested dielectrics: what encloses both sides of the last surface that was met.
struct Enclosure {
  // What encloses a ray that leaves the surface.
  const Enclosing& along(Vec3 direction) const { return dot(direction, normal) < 0 ? inside : outside; }

  Enclosing outside{}, inside{};
  Vec3 normal{};                       // geometric, outward
  const Material* boundary = nullptr;  // what scatters there in place of the hit's material; null for that
};

// Calls pass(i, rays[i], hits[i], crossing) for each hit. If it returns a ray that continues behind the
// surface, traces that ray, and repeats until none continues. rays[i] and hits[i] become those of the last
// segment. `crossing` counts the surfaces passed so far. Returns the number of rays traced.
template <typename Pass>
std::uint64_t trace_through(const Scene& scene, ColumnsView<Ray> rays, ColumnsView<Hit> hits,
                            const Pass& pass) {
  std::vector<std::uint32_t> active;  // rays that have passed all their hits
  Columns<Ray> active_rays;
  Columns<Hit> next_hits;
  const auto advance = [&](std::uint32_t i, std::uint32_t crossing) {
    const Hit hit = hits[i];
    if (!hit.found()) return;
    const std::optional<Ray> beyond = pass(i, rays[i], hit, crossing);
    if (!beyond) return;
    rays.set(i, *beyond);
    active.push_back(i);
    active_rays.push(*beyond);
  };
  std::uint64_t traced = 0;
  for (std::uint32_t i = 0; i < rays.size(); ++i) advance(i, 0);
  for (std::uint32_t crossing = 1; !active.empty(); ++crossing) {
    next_hits.resize(active_rays.size());
    scene.closest_hits(active_rays.all(), next_hits.all());
    traced += active_rays.size();
    const auto behind = std::exchange(active, {});
    active_rays.clear();
    for (std::size_t k = 0; k < behind.size(); ++k) {
      hits.set(behind[k], next_hits[k]);
      advance(behind[k], crossing);
    }
  }
  return traced;
}

// What a ray meets at the surface it hit.
struct Crossing {
  const Material* material = nullptr;  // null if the surface has no effect
  SurfacePoint surface{};              // if rays pass, or among nested dielectrics
  float hit = 1;                       // the probability that it is scattered; 1: the surface stops every ray
  Rgb transmittance{};                 // of a shadow ray
  bool emits = false;                  // towards rays that pass

  // The weight of rays that pass.
  Rgb tint() const { return transmittance / (1 - hit); }
};
// `enclosure`, where the ray begins, becomes that of the surface.
Crossing crossing_at(const Scene& scene, RayOrigin origin, const Ray& ray, const Hit& hit,
                     std::uint32_t crossing, Enclosure& enclosure);
// The rest of a shadow ray behind a surface; nothing if the surface is at its end.
std::optional<Ray> rest_of(const Ray& whole, const SurfacePoint& surface);

// Stochastically passes rays[i] through the surfaces they hit. sampler_of(i) is the sampler of the ray's
// sample, and name_of(i) distinguishes the rays of that sample; enclosure_of(i) is where the ray begins, and
// becomes that of the surface it hits; on_pass(i, ray, hit, crossing) is called for each surface passed,
// whose tint multiplies what the ray carries on. Returns the number of rays traced.
template <typename NameOf, typename SamplerOf, typename EnclosureOf, typename OnPass>
std::uint64_t pass_by_chance(const Scene& scene, RayOrigin origin, ColumnsView<Ray> rays,
                             ColumnsView<Hit> hits, const NameOf& name_of, const SamplerOf& sampler_of,
                             const EnclosureOf& enclosure_of, const OnPass& on_pass) {
  const auto pass = [&](std::uint32_t i, const Ray& ray, const Hit& hit,
                        std::uint32_t crossing) -> std::optional<Ray> {
    const Crossing met = crossing_at(scene, origin, ray, hit, crossing, enclosure_of(i));
    if (met.hit >= 1) return std::nullopt;
    if (met.hit > 0 && sampler_of(i).opacity_number(name_of(i), crossing) < met.hit) return std::nullopt;
    on_pass(i, ray, hit, met);
    return Ray{offset_origin(met.surface, ray.direction), ray.direction, ray.t_max, ray.time};
  };
  return trace_through(scene, rays, hits, pass);
}

// A ray and its hit.
struct Met {
  Ray ray;  // starts behind the last surface passed
  Hit hit;
  std::uint64_t traced = 1;  // the number of rays traced
  Rgb tint = Rgb::gray(1);   // of the surfaces passed
};
// Is called for each surface that a ray passes, with the tint of those before it.
using OnPass = std::function<void(const Ray& ray, const Hit& hit, const Crossing& crossing, Rgb tint)>;
// Traces one ray stochastically, as pass_by_chance does.
Met meet_by_chance(const Scene& scene, RayOrigin origin, const Ray& ray, const sampling::Sampler& sampler,
                   std::uint64_t name, Enclosure& enclosure, const OnPass& on_pass = {});

// Stores the transmittance along each shadow ray rays[i], which begins at enclosures[i], in shares[i]. The
// enclosures change on the way. Returns the number of rays traced.
std::uint64_t find_transmittances(const Scene& scene, ColumnsView<const Ray> rays,
                                  std::span<Enclosure> enclosures, std::span<Rgb> shares);
// The transmittance of one ray. Adds the number of rays traced to `traced`.
Rgb transmittance(const Scene& scene, const Ray& ray, Enclosure enclosure, std::uint64_t& traced);

}  // namespace tessera::core::integrators
