// SPDX-License-Identifier: Apache-2.0
// Rays and surfaces that let light pass straight through: by their opacity, or as panes do (interception_at).
// A scattering ray hits such a surface with a probability, and otherwise goes on behind it, tinted; a shadow
// ray is attenuated by the transmittance. The expectation of the former equals the latter. Stateless;
// thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// The maximum number of surfaces that a ray crosses. The next one is treated as opaque, so that every ray
// ends.
inline constexpr std::uint32_t kMaxCrossings = 1u << 14;

// Calls pass(i, rays[i], hits[i], crossing) for each hit. If it returns a ray that continues behind the
// surface, traces that ray, and repeats until none continues. rays[i] and hits[i] become those of the last
// segment. `crossing` counts the surfaces passed so far. Returns the number of rays traced.
template <typename Pass>
std::uint64_t trace_through(const Scene& scene, std::span<Ray> rays, std::span<Hit> hits, const Pass& pass) {
  std::vector<std::uint32_t> active;  // rays that have passed all their hits
  std::vector<Ray> active_rays;
  std::vector<Hit> next_hits;
  const auto advance = [&](std::uint32_t i, std::uint32_t crossing) {
    if (!hits[i].found()) return;
    const std::optional<Ray> beyond = pass(i, rays[i], hits[i], crossing);
    if (!beyond) return;
    rays[i] = *beyond;
    active.push_back(i);
    active_rays.push_back(*beyond);
  };
  std::uint64_t traced = 0;
  for (std::uint32_t i = 0; i < rays.size(); ++i) advance(i, 0);
  for (std::uint32_t crossing = 1; !active.empty(); ++crossing) {
    next_hits.resize(active_rays.size());
    scene.bvh().closest_hits(scene.primitives(), active_rays, next_hits);
    traced += active_rays.size();
    const auto behind = std::exchange(active, {});
    active_rays.clear();
    for (std::size_t k = 0; k < behind.size(); ++k) {
      hits[behind[k]] = next_hits[k];
      advance(behind[k], crossing);
    }
  }
  return traced;
}

// What a ray meets at the surface it hit.
struct Crossing {
  SurfacePoint surface;
  float hit = 1;        // the probability that it is scattered; 1 where the surface stops every ray
  Rgb transmittance{};  // of a shadow ray

  // The weight of rays that pass.
  Rgb tint() const { return transmittance / (1 - hit); }
};
Crossing crossing_at(const Scene& scene, const Ray& ray, const Hit& hit, std::uint32_t crossing);
// The rest of a shadow ray behind a surface; nothing if the surface is at its end.
std::optional<Ray> rest_of(const Ray& whole, const SurfacePoint& surface);

// Stochastically passes rays[i] through the surfaces they hit. sampler_of(i) is the sampler of the ray's
// sample, and name_of(i) distinguishes the rays of that sample; weigh(i, tint) multiplies what the ray
// carries. Returns the number of rays traced.
template <typename NameOf, typename SamplerOf, typename Weigh>
std::uint64_t pass_by_chance(const Scene& scene, std::span<Ray> rays, std::span<Hit> hits,
                             const NameOf& name_of, const SamplerOf& sampler_of, const Weigh& weigh) {
  const auto pass = [&](std::uint32_t i, const Ray& ray, const Hit& hit,
                        std::uint32_t crossing) -> std::optional<Ray> {
    const Crossing met = crossing_at(scene, ray, hit, crossing);
    if (met.hit >= 1) return std::nullopt;
    if (met.hit > 0 && sampler_of(i).opacity_number(name_of(i), crossing) < met.hit) return std::nullopt;
    weigh(i, met.tint());
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
// Traces one ray stochastically, as pass_by_chance does.
Met meet_by_chance(const Scene& scene, const Ray& ray, const Sampler& sampler, std::uint64_t name);

// Stores the transmittance along each shadow ray rays[i] in shares[i]. Returns the number of rays traced.
std::uint64_t find_transmittances(const Scene& scene, std::span<const Ray> rays, std::span<Rgb> shares);
// The transmittance of one ray. Adds the number of rays traced to `traced`.
Rgb transmittance(const Scene& scene, const Ray& ray, std::uint64_t& traced);

}  // namespace tessera::core
