// SPDX-License-Identifier: Apache-2.0
// Rays and surfaces whose opacity is below 1. A ray that scatters light meets each of them with the
// probability of its opacity, and passes straight through it otherwise; a shadow ray loses the share of the
// opacity. Both are right for each other: the expectation of the one is the other. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// So many surfaces are crossed by a ray at most. The next one is as good as opaque, so that every ray ends.
inline constexpr std::uint32_t kMaxCrossings = 1u << 14;

// Where hits[i], which rays[i] found, is passed by pass(i, rays[i], hits[i], crossing), which answers with
// the ray behind it, traces on until none is. Both become those of the last segment. `crossing` counts the
// surfaces that a ray has passed. Answers with the number of rays traced.
template <typename Pass>
std::uint64_t trace_through(const Scene& scene, std::span<Ray> rays, std::span<Hit> hits, const Pass& pass) {
  std::vector<std::uint32_t> active;  // those that have passed all they hit
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

// A ray that continues behind the surface that it hit, and which share of it does.
struct Crossing {
  SurfacePoint surface;
  float opacity;  // of the surface there; 1 where it stops every ray
};
Crossing crossing_at(const Scene& scene, const Ray& ray, const Hit& hit, std::uint32_t crossing);

// Lets rays[i] pass by chance through what it hits. sampler_of(i) is the sampler of its sample, and name_of(i) tells
// it from the other rays of that sample. Returns the number of rays traced.
template <typename NameOf, typename SamplerOf>
std::uint64_t pass_by_chance(const Scene& scene, std::span<Ray> rays, std::span<Hit> hits, const NameOf& name_of,
                             const SamplerOf& sampler_of) {
  const auto pass = [&](std::uint32_t i, const Ray& ray, const Hit& hit,
                        std::uint32_t crossing) -> std::optional<Ray> {
    const auto [surface, opacity] = crossing_at(scene, ray, hit, crossing);
    if (opacity >= 1) return std::nullopt;
    if (opacity > 0 && sampler_of(i).opacity_number(name_of(i), crossing) < opacity) return std::nullopt;
    return Ray{offset_origin(surface, ray.direction), ray.direction, ray.t_max};
  };
  return trace_through(scene, rays, hits, pass);
}

// A ray and what it has met.
struct Met {
  Ray ray;  // from behind the last surface that it has passed
  Hit hit;
  std::uint64_t traced = 1;  // how many rays that took
};
// What one ray meets, by chance as pass_by_chance has it.
Met meet_by_chance(const Scene& scene, const Ray& ray, const Sampler& sampler, std::uint64_t name);

// The share of the light along rays[i], each a shadow ray, that arrives, as shares[i]. Answers with the
// number of rays traced.
std::uint64_t find_transmittances(const Scene& scene, std::span<const Ray> rays, std::span<float> shares);
// Of one ray. The number of rays traced is added to `traced`.
float transmittance(const Scene& scene, const Ray& ray, std::uint64_t& traced);

}  // namespace tessera::core
