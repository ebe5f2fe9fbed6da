// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/first_hits.hpp"

#include "core/integrators/opacity.hpp"
#include "core/integrators/shading_normal.hpp"
#include "core/integrators/vertex.hpp"
#include "core/materials/base_color.hpp"

namespace tessera::core::integrators {
namespace {

// `ray` begins behind the last surface that it passed, and `origin` is that of the camera ray.
FirstHit describe(const Scene& scene, const Ray& ray, const Hit& hit, Vec3 origin) {
  FirstHit first;
  if (!hit.found()) return first;
  const SurfacePoint surface = scene.primitives().surface(ray, hit);
  const Vec3 wo = normalize(-ray.direction);
  const Material& scatterer = scatterer_of(scene, hit, surface, wo);
  first.found = true;
  first.albedo = base_color_at(scatterer, scene.textures(), texture_point_at(scene, hit, surface),
                               scene.primitives().vertex_color(hit));
  first.normal =
      ViewedSide<float>(surface, wo).shading_normal(outward_normal(scene, scatterer, hit, surface), wo);
  first.position = surface.position;
  first.uv = surface.uv;
  first.depth = scene.camera_depth(origin, surface.position, ray.time);
  const std::uint32_t shape = scene.ids().shape_of(hit), material = scene.primitives().material(hit);
  first.object = shape + 1;
  first.material = material + 1;
  first.instance = hit.in_instance() ? hit.instance + 1 : 0;
  first.crypto_object = scene.ids().crypto_object(shape);
  first.crypto_material = scene.ids().crypto_material(material);
  first.crypto_asset = scene.ids().crypto_asset(shape);
  return first;
}

}  // namespace

std::uint64_t find_first_hits(const Scene& scene, std::span<const Ray> camera_rays,
                              std::span<const sampling::Sampler* const> samplers, std::span<FirstHit> hits) {
  Columns<Ray> rays(camera_rays);
  Columns<Hit> met(rays.size());
  scene.closest_hits(rays.all(), met.all());
  std::uint64_t traced = rays.size();
  // The camera ray is ray 0 of a sample for every integrator: the path of depth 0, the root of the tree.
  static_assert(sampling::kTreeRoot == 0);
  std::vector<Enclosure> enclosures(scene.is_opaque() ? 0 : rays.size());
  if (!scene.is_opaque())
    traced += pass_by_chance(
        scene, RayOrigin::kCamera, rays.all(), met.all(), [](std::uint32_t) { return sampling::kTreeRoot; },
        [&](std::uint32_t i) -> const sampling::Sampler& { return *samplers[i]; },
        [&](std::uint32_t i) -> Enclosure& { return enclosures[i]; },
        [](std::uint32_t, const Ray&, const Hit&, const Crossing&) {});
  for (std::size_t i = 0; i < rays.size(); ++i)
    hits[i] = describe(scene, rays[i], met[i], camera_rays[i].origin);
  return traced;
}

}  // namespace tessera::core::integrators
