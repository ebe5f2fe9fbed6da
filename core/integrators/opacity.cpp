// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/opacity.hpp"

#include <algorithm>
#include <cmath>

#include "core/integrators/vertex.hpp"
#include "core/materials/blend.hpp"

namespace tessera::core {

std::optional<Ray> rest_of(const Ray& whole, const SurfacePoint& surface) {
  const Vec3 origin = offset_origin(surface, whole.direction);
  if (!std::isfinite(whole.t_max)) return Ray{origin, whole.direction, whole.t_max, whole.time};
  const Vec3 rest = whole.origin + whole.direction * whole.t_max - origin;
  if (!(dot(rest, whole.direction) > 0)) return std::nullopt;
  return Ray{origin, rest, 1, whole.time};
}

Crossing crossing_at(const Scene& scene, const Ray& ray, const Hit& hit, std::uint32_t crossing) {
  const Material& material = scene.material_of(hit);
  if (is_opaque(material, scene.materials()) || crossing >= kMaxCrossings) return {};
  const SurfacePoint surface = scene.primitives().surface(ray, hit);
  const auto [stopped, transmittance] =
      interception_at(material, scene.materials(), scene.textures(), uv_sets_at(scene, hit, surface),
                      meeting_cosine(surface, normalize(ray.direction)), is_behind(surface, -ray.direction));
  return {surface, stopped, transmittance};
}

Met meet_by_chance(const Scene& scene, const Ray& ray, const Sampler& sampler, std::uint64_t name) {
  Met met{ray, scene.bvh().closest_hit(scene.primitives(), ray)};
  if (scene.is_opaque() || !met.hit.found()) return met;
  met.traced += pass_by_chance(
      scene, {&met.ray, 1}, {&met.hit, 1}, [&](std::uint32_t) { return name; },
      [&](std::uint32_t) -> const Sampler& { return sampler; },
      [&](std::uint32_t, Rgb tint) { met.tint *= tint; });
  return met;
}

std::uint64_t find_transmittances(const Scene& scene, std::span<const Ray> rays, std::span<Rgb> shares) {
  std::vector<Ray> segments(rays.begin(), rays.end());
  std::vector<Hit> hits(rays.size());
  scene.bvh().closest_hits(scene.primitives(), rays, hits);
  std::fill(shares.begin(), shares.end(), Rgb::gray(1));
  const auto pass = [&](std::uint32_t i, const Ray& segment, const Hit& hit,
                        std::uint32_t crossing) -> std::optional<Ray> {
    const Crossing met = crossing_at(scene, segment, hit, crossing);
    shares[i] *= met.transmittance;
    if (is_black(shares[i])) return std::nullopt;
    return rest_of(rays[i], met.surface);
  };
  return rays.size() + trace_through(scene, segments, hits, pass);
}

Rgb transmittance(const Scene& scene, const Ray& ray, std::uint64_t& traced) {
  ++traced;
  if (!scene.bvh().any_hit(scene.primitives(), ray)) return Rgb::gray(1);
  if (scene.is_opaque()) return {};
  Rgb share{};
  traced += find_transmittances(scene, {&ray, 1}, {&share, 1});
  return share;
}

}  // namespace tessera::core
