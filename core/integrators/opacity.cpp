// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/opacity.hpp"

#include <algorithm>
#include <cmath>

#include "core/integrators/vertex.hpp"
#include "core/materials/blend.hpp"

namespace tessera::core::integrators {

std::optional<Ray> rest_of(const Ray& whole, const SurfacePoint& surface) {
  const Vec3 origin = offset_origin(surface, whole.direction);
  if (!std::isfinite(whole.t_max)) return Ray{origin, whole.direction, whole.t_max, whole.time};
  const Vec3 rest = whole.origin + whole.direction * whole.t_max - origin;
  if (!(dot(rest, whole.direction) > 0)) return std::nullopt;
  return Ray{origin, rest, 1, whole.time};
}

namespace {

// Moves `enclosure` to a surface of a nested dielectric. Whether the surface has an effect; if not, its
// boundary is that of the material alone.
bool enter_surface(const Scene& scene, std::uint32_t material, const Ray& ray, const SurfacePoint& surface,
                   Enclosure& enclosure) {
  const NestedDielectrics& nested = scene.nested_dielectrics();
  const Enclosing near = enclosure.along(ray.direction);
  const bool leaves = is_behind(surface, -ray.direction);
  enclosure.outside = leaves ? nested.outside_of(material, near) : near;
  enclosure.inside = leaves ? near : nested.inside_of(material, near);
  enclosure.normal = surface.geometric_normal;
  const auto boundary = nested.boundary(material, enclosure.outside);
  enclosure.boundary = &scene.materials()[boundary ? *boundary : *nested.boundary(material, {})];
  return boundary.has_value();
}

}  // namespace

Crossing crossing_at(const Scene& scene, RayOrigin origin, const Ray& ray, const Hit& hit,
                     std::uint32_t crossing, Enclosure& enclosure) {
  const std::uint32_t index = scene.primitives().material(hit);
  const Material* material = &scene.materials()[index];
  if (origin == RayOrigin::kCamera && !material->visible_to_camera && crossing < kMaxCrossings)
    return {nullptr, scene.primitives().surface(ray, hit), 0, Rgb::gray(1)};
  SurfacePoint surface;
  const bool is_nested = scene.nested_dielectrics().contains(index);
  if (is_nested) {
    surface = scene.primitives().surface(ray, hit);
    if (!enter_surface(scene, index, ray, surface, enclosure) && crossing < kMaxCrossings)
      return {nullptr, surface, 0, Rgb::gray(1)};
    material = enclosure.boundary;
  } else if (!scene.nested_dielectrics().empty()) {
    enclosure = {.outside = enclosure.along(ray.direction), .inside = enclosure.along(ray.direction)};
  }
  const bool is_opaque_there =
      is_nested ? is_opaque(*material, scene.materials()) : scene.opacity_of(hit) == accel::Opacity::kOpaque;
  if (is_opaque_there || crossing >= kMaxCrossings) return {material, surface};
  if (!is_nested) surface = scene.primitives().surface(ray, hit);
  const auto [stopped, transmittance] =
      interception_at(*material, scene.materials(), scene.textures(), texture_point_at(scene, hit, surface),
                      meeting_cosine(surface, normalize(ray.direction)), is_behind(surface, -ray.direction));
  return {material, surface, stopped, transmittance, emits_in_passing(*material)};
}

Met meet_by_chance(const Scene& scene, RayOrigin origin, const Ray& ray, const sampling::Sampler& sampler,
                   std::uint64_t name, Enclosure& enclosure, const OnPass& on_pass) {
  Met met{ray, scene.closest_hit(ray)};
  if (scene.is_opaque() || !met.hit.found()) return met;
  SingleRow segment(met.ray);
  SingleRow found(met.hit);
  met.traced += pass_by_chance(
      scene, origin, segment.all(), found.all(), [&](std::uint32_t) { return name; },
      [&](std::uint32_t) -> const sampling::Sampler& { return sampler; },
      [&](std::uint32_t) -> Enclosure& { return enclosure; },
      [&](std::uint32_t, const Ray& passing, const Hit& hit, const Crossing& crossing) {
        if (on_pass) on_pass(passing, hit, crossing, met.tint);
        met.tint *= crossing.tint();
      });
  met.ray = segment.row();
  met.hit = found.row();
  return met;
}

std::uint64_t find_transmittances(const Scene& scene, ColumnsView<const Ray> rays,
                                  std::span<Enclosure> enclosures, std::span<Rgb> shares) {
  Columns<Ray> segments(rays);
  Columns<Hit> hits(rays.size());
  scene.closest_hits(rays, hits.all());
  std::fill(shares.begin(), shares.end(), Rgb::gray(1));
  const auto pass = [&](std::uint32_t i, const Ray& segment, const Hit& hit,
                        std::uint32_t crossing) -> std::optional<Ray> {
    const Crossing met = crossing_at(scene, RayOrigin::kScene, segment, hit, crossing, enclosures[i]);
    shares[i] *= met.transmittance;
    if (is_black(shares[i])) return std::nullopt;
    return rest_of(rays[i], met.surface);
  };
  return rays.size() + trace_through(scene, segments.all(), hits.all(), pass);
}

Rgb transmittance(const Scene& scene, const Ray& ray, Enclosure enclosure, std::uint64_t& traced) {
  ++traced;
  const accel::Occlusion occlusion = scene.occlusion(ray);
  if (occlusion != accel::Occlusion::kPartial)
    return Rgb::gray(occlusion == accel::Occlusion::kNone ? 1.0f : 0.0f);
  Rgb share{};
  traced += find_transmittances(scene, SingleRow(ray).all(), {&enclosure, 1}, {&share, 1});
  return share;
}

}  // namespace tessera::core::integrators
